#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The meshes before trimesh, meshio, PyVista, DiSimPy's loader and MC/DC's rules, where those are installed.  meshes.sh BIN
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import importlib.util, sys; sys.exit(not all(map(importlib.util.find_spec, ("disimpy", "h5py", "meshio", "pyvista", "trimesh"))))' 2> /dev/null ||
  { echo "SKIPPED: no Python with disimpy, h5py, meshio, pyvista and trimesh: meshes are not read by others"; exit 77; }
exec "$python" "$(dirname "$0")/meshes.py" "$1"
