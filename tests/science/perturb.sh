#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Controlled perturbation, from recipe to signal: a factor of 1 is the unperturbed pair, the extracellular space comes to what its factor asks,
# and apps/examples/perturb.py tells the differences.  perturb.sh BIN SOURCE
. "$(dirname -- "$0")/../pipe/common.sh"
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2>/dev/null || skip "no Python with h5py and numpy: the sweep is not run"
[ -x "$bin/conceg-fit" ] || skip "this build has no fit stage (libceres-dev)"
sed 's/\[28, 28, 28\]/[24, 24, 24]/; s/h_um: 0.3/h_um: 0.5/; s/1.4e-4/2.2e-4/' "$root/tests/pipe/small.yaml" > small.yaml

conceg run small.yaml --until relax -q -o plain.cgx || exit 1
conceg run small.yaml --until relax -q --set perturb.neurons=1 --set perturb.dendrites=1.0 --set perturb.glia=1 --set perturb.ecs=1 -o one.cgx || exit 1
check "factors of 1 leave every byte" cmp one.cgx plain.cgx
conceg run small.yaml --until relax -q --set perturb.glia=3 -o glia.cgx || exit 1
check_not "three times the glia do not" conceg diff -q glia.cgx plain.cgx

# asked = 1 - p (1 - phi), reached both ways.
for factor in 0.93 1.07; do
  conceg run small.yaml --until relax -v --set perturb.ecs=$factor -o ecs.cgx 2> log || exit 1
  line=$(grep 'volume fraction behind contact planes' log)
  echo "ecs $factor: $line"
  check "ecs $factor comes to what it asks" sh -c "printf '%s\n' '$line' | awk -v p=$factor '{ for (i = 1; i <= NF; i++) { if (\$i == \"planes:\") before = \$(i + 1); if (\$i == \"inflation,\") after = \$(i + 1); if (\$i == \"asked\") asked = \$(i + 1) }
    exit !(before > 0.1 && (asked - 1 + p * (1 - before))^2 < 1e-7 && (after - asked)^2 < 1e-6 && (after - before)^2 > 1e-4) }'"
  check "and says nothing of a limit" sh -c '! grep -q "relax: icvf: asked" log'
done
check "what cannot be reached is said" sh -c "conceg run small.yaml --until relax --set perturb.ecs=0.3 -o ecs.cgx 2>&1 | grep -q 'relax: icvf: asked .* reached'"
conceg run small.yaml --until place -q --set perturb.neurons=0 --set perturb.glia=0 -o none.cgx 2> error && check "no cell left is an error" false
check "and says which factor" grep -q 'perturb.glia: expected a cell to be left' error

"$python" "$root/apps/examples/perturb.py" sweep --recipe small.yaml --walkers 400 --conceg "$bin/conceg" --only none=1 glia=1 neurons=0.5 2> /dev/null > table || { cat table; check "the sweep" false; }
cat table
check "a table of three levels" test "$(wc -l < sweep/perturbation.csv)" = 4
"$python" - <<'READ'
import csv
rows = {(r["factor"], r["level"]): r for r in csv.DictReader(open("sweep/perturbation.csv"))}
same, less = rows["glia", "1"], rows["neurons", "0.5"]
names = [n[:-7] for n in same if n.endswith("_change")]
assert len(names) == 10, names
for n in names: # the pair is the same substrate: no difference, and walkers that saw the same
    assert float(same[n + "_change"]) == 0, (n, same[n + "_change"])
assert float(same["S(b=3)_change_error"]) == 0
assert float(less["icvf_change"]) < -0.02 and float(less["S(b=3)_change"]) < 0 # fewer cells: more free water
assert 0 < float(less["S(b=3)_change_error"]) < 1.5 * (float(less["S(b=3)_error"]) ** 2 + float(rows["none", "1"]["S(b=3)_error"]) ** 2) ** 0.5
READ
check "a pair without a difference has none, one with fewer neurons has" test $? = 0
check "a factor that is none is refused" sh -c "'$python' '$root/apps/examples/perturb.py' sweep --only bones=2 2>&1 | grep -q 'expected none=1, or neurons'"
done_checking
