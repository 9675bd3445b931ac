#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The default recipe with other seeds, and the paper's choices: other tissues, held to the same checks but for the density.
. "$(dirname -- "$0")/../pipe/common.sh"
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2>/dev/null || skip "no Python with h5py and numpy: other seeds are not measured by a foreign reader"
for seed in 1 2 3 4 5; do
  conceg run "$root/apps/recipes/cube.yaml" --seed $seed -q -o cube.cgx
  check "seed $seed: valid" conceg validate -q cube.cgx
  check "seed $seed: a foreign reader agrees" "$python" "$root/tests/science/check_tissue.py" cube.cgx --icvf-at-least 0.2
done
conceg run "$root/apps/recipes/paper.yaml" -q -o paper.cgx
check "the paper's choices: a foreign reader agrees" "$python" "$root/tests/science/check_tissue.py" paper.cgx --icvf-at-least 0.2
conceg run "$root/apps/recipes/single-cell.yaml" -q -o single.cgx
check "one cell: a foreign reader agrees" "$python" "$root/tests/science/check_tissue.py" single.cgx
done_checking
