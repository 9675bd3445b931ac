#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The default recipe gives what the README promises, measured again by a reader that is not ours.
. "$(dirname -- "$0")/../pipe/common.sh"
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2>/dev/null || skip "no Python with h5py and numpy: the cube is not measured again by a foreign reader"
conceg run "$root/apps/recipes/cube.yaml" -q -o cube.cgx
check "the document is valid" conceg validate -q cube.cgx
check "a foreign reader agrees" "$python" "$root/tests/science/check_tissue.py" cube.cgx --icvf-at-least 0.35
# A planted defect: one triangle turned round must be found, or the check above means nothing.
"$python" - <<'PLANT'
import h5py, shutil
shutil.copy("cube.cgx", "broken.cgx")
with h5py.File("broken.cgx", "r+") as document:
    document["meshes/face"][0] = document["meshes/face"][0][::-1]
PLANT
check_not "a turned triangle is found" sh -c "'$python' '$root/tests/science/check_tissue.py' broken.cgx >/dev/null"
done_checking
