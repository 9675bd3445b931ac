#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Exported files before other programs' readers, where they are installed.  peers.sh BIN
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import importlib.util, sys; sys.exit(not all(map(importlib.util.find_spec, ("h5py", "meshio", "morphio", "navis", "neurom", "nibabel", "pyvista", "trimesh"))))' 2> /dev/null ||
  { echo "SKIPPED: no Python with h5py, meshio, morphio, navis, neurom, nibabel, pyvista and trimesh: exported files are not read by others"; exit 77; }
exec "$python" "$(dirname "$0")/peers.py" "$1"
