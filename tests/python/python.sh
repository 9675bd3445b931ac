#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# apps/python installed by pip into a folder of its own, then one part of its tests.  python.sh SOURCE BUILD package|stages
source=$1 build=$2 part=$3
python=${CONCEG_PYTHON:-python3}
for module in numpy h5py pandas trimesh pyvista setuptools pip; do
  "$python" -c "import importlib.util, sys; sys.exit(importlib.util.find_spec('$module') is None)" 2> /dev/null ||
    { echo "SKIPPED: no Python with $module: the Python package is not tried"; exit 77; }
done
t=$(mktemp -d) || exit 1
trap 'rm -rf "$t"' EXIT
cp -r "$source/apps/python" "$t/source" && rm -rf "$t/source/build" "$t/source"/*.egg-info
"$python" -m pip install -q --disable-pip-version-check --no-index --no-deps --no-build-isolation --target "$t/site" "$t/source" > "$t/log" 2>&1 ||
  { echo "FAILED: pip install apps/python"; cat "$t/log"; exit 1; }
[ -e "$t/site/conceg/py.typed" ] || { echo "FAILED: py.typed is not installed"; exit 1; }
if [ "$part" = package ]; then
  if "$python" -c 'import mypy' 2> /dev/null; then
    (cd "$t/source" && "$python" -m mypy --cache-dir "$t/cache") > "$t/log" 2>&1 || { echo "FAILED: mypy --strict"; cat "$t/log"; exit 1; }
    tail -1 "$t/log"
    echo 'first: int = "no number"' >> "$t/source/conceg/substrate.py"
    (cd "$t/source" && "$python" -m mypy --cache-dir "$t/cache") > "$t/log" 2>&1 && { echo "FAILED: mypy sees nothing in a planted error"; exit 1; }
  else
    echo "mypy is not here: types were not checked"
  fi
fi
mkdir "$t/tmp"
cd "$t" || exit 1
CONCEG_LIBRARY=$build/lib TMPDIR=$t/tmp PYTHONPATH=$t/site "$python" -W error::ResourceWarning "$source/tests/python/$part.py" "$source" "$build" || exit 1
[ -z "$(ls "$t/tmp")" ] || { echo "FAILED: left in the temporary folder: $(ls "$t/tmp")"; exit 1; }
