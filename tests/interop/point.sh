#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# One asymmetric place in every format, where other programs' readers are installed.  point.sh BIN
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import importlib.util, sys; sys.exit(not all(map(importlib.util.find_spec, ("h5py", "meshio", "morphio", "nibabel", "pyvista", "trimesh"))))' 2> /dev/null ||
  { echo "SKIPPED: no Python with h5py, meshio, morphio, nibabel, pyvista and trimesh: places in written files are not looked at"; exit 77; }
exec "$python" "$(dirname "$0")/point.py" "$1"
