#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A writer that shares nothing with ours makes the passed documents from their text twins, and some failed ones; and a foreign tool
# that changes /skeleton makes readers of /meshes warn.
. "$(dirname -- "$0")/../pipe/common.sh"
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2>/dev/null || skip "no Python with h5py and numpy: the corpus is not written by a foreign writer"
corpus=$root/spec/conformance
mkdir passed failed
check "h5py writes the documents" "$python" "$root/tests/spec/foreign.py" "$corpus" "$scratch"
written=0
for twin in "$corpus"/passed/*.txt; do
  name=$(basename "$twin" .txt)
  written=$((written + 1))
  check "$name is valid" conceg validate -q "passed/$name.cgx"
  conceg dump "passed/$name.cgx" >dumped
  check "$name says what its twin says" cmp dumped "$twin"
done
check "documents were written" [ "$written" -ge 20 ]
check "the failed ones get their verdicts" conceg validate --expect manifest.tsv
check_not "another text is seen" sh -c 'sed s/40/41/ "$1"/passed/0003-box.txt >other; conceg dump passed/0003-box.cgx | cmp -s - other' sh "$corpus"

# What ConCeG cannot hold itself is carried through a program, value for value.
conceg strip domain "$corpus/roundtrip/0004-compound.cgx" -o carried.cgx
check "compounds are carried through" "$python" -c 'import h5py, sys
with h5py.File(sys.argv[1]) as before, h5py.File("carried.cgx") as after:
    a, b = before["x_lab/pairs"], after["x_lab/pairs"]
    assert a.dtype == b.dtype and a[...].tolist() == b[...].tolist() == [(1, 2), (3, 4), (5, 6)]
    assert after["x_lab/values"].attrs["pair"].tolist() == (1, 2)' "$corpus/roundtrip/0004-compound.cgx"

# Meshes of a skeleton that was changed afterwards.
cp "$corpus/passed/0017-made-from.cgx" moved.cgx
chmod u+w moved.cgx
"$python" -c 'import h5py
with h5py.File("moved.cgx", "r+") as document: document["skeleton/position"][0, 0] += 0.5'
conceg validate moved.cgx >said
check "validate warns" grep -q '^warning CGX-070 /meshes@made_from\[0\]: expected /skeleton as it was' said
check_not "and not before" sh -c 'conceg validate "$1"/passed/0017-made-from.cgx | grep -q CGX-070' sh "$corpus"
if command -v conceg-analyse >/dev/null; then
  conceg analyse moved.cgx -o analysed.cgx 2>warned || true
  check "analyse warns" grep -q 'warning: .*/meshes was made from another /skeleton' warned
  conceg analyse "$corpus/passed/0017-made-from.cgx" -o analysed.cgx 2>warned || true
  check_not "and not of the unchanged one" grep -q 'made from another' warned
fi
done_checking
