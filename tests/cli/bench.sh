#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# conceg bench scaling: boxes are run, kept and gone on with, the fit of a planted law, what is refused.  bench.sh BIN
bin=$1
. "$(dirname "$0")/expect.sh"
source=$(CDPATH= cd -- "$(dirname "$0")/../.." && pwd)
PATH=$bin:$PATH
export PATH
[ -x "$bin/conceg-mesh" ] || { echo "SKIPPED: this build has no mesh stage (libcgal-dev)"; exit 77; }
[ -x "$bin/conceg-triangulate" ] || { echo "SKIPPED: this build has no triangulate stage (CONCEG_GPL)"; exit 77; }
cd "$expect_folder" || exit 1
recipe=$source/tests/pipe/small.yaml

expect 0 "" conceg bench --help
expect_output "usage: conceg bench scaling RECIPE"
expect_output "^example:"
expect 2 "expected scaling" conceg bench
expect 2 "which recipe" conceg bench scaling
expect 2 "give a folder with -o DIR" conceg bench scaling "$recipe"
expect 2 "sides of 1 to 10000 um" conceg bench scaling "$recipe" --sides 20,x -o out
expect 2 "sides of 1 to 10000 um" conceg bench scaling "$recipe" --sides 20:1.5 -o out
expect 2 "20 um stands twice" conceg bench scaling "$recipe" --sides 20,20 -o out
expect 2 "not among the stages" conceg bench scaling "$recipe" --until bake -o out
expect 4 "no such file|cannot be read|cannot open" conceg bench scaling absent.yaml -o out
expect_true "nothing was made" test ! -e out

# Two boxes by their number of cells, through all stages; the second call keeps the first one's box.
expect 0 "box 1 of 1, 16 um: mesh" conceg bench scaling "$recipe" --threads 1 --set mesh.h_um=0.5 --sides 16:1 -o out
expect 0 "box 1 of 2, 16 um: kept from before" conceg bench scaling "$recipe" --threads 1 --set mesh.h_um=0.5 --sides 16:1,20:2 -o out
expect_output "^side .um. +cells +nodes +triangles +icvf"
expect_output "^20 +2 +[1-9][0-9]+ +[1-9][0-9]+ +0\.[0-9]+"
expect_output "^wall time: void: fewer than 3 boxes"
expect_true "five stages of two boxes" test "$(grep -cE ',(place|triangulate|grow|relax|mesh),' out/scaling.csv)" -eq 10
expect_true "no document is left" sh -c '! ls -A out | grep -vE "^scaling\.(csv|json|svg)$"'
expect 2 "another recipe, version, seed or number of threads" conceg bench scaling "$recipe" --threads 1 --sides 16:1 -o out
cp -r out before
expect 0 "" conceg bench scaling "$recipe" --threads 1 --set mesh.h_um=0.5 --sides 20:2 -o out -q
expect_same before/scaling.csv out/scaling.csv
if command -v python3 > /dev/null; then
  expect_true "JSON and SVG read" python3 -c '
import json, xml.etree.ElementTree as xml
found = json.load(open("out/scaling.json"))
assert [b["cells"] for b in found["boxes"]] == [1, 2] and found["machine"]["processors"] > 0
assert all(s["peak_mib"] > 1 and s["wall_s"] > 0 for b in found["boxes"] for s in b["stages"])
assert found["fits"]["all_wall"] is None
xml.parse("out/scaling.svg")'
fi

# A planted law: seconds of both stages together 50 (V / 1e6)^1.077. Cells by number take no part.
mkdir planted
expect 0 "" conceg bench scaling "$recipe" --threads 1 --until triangulate --sides 16:1 -o two -q
key=$(sed -n 2p two/scaling.csv | cut -d, -f1-4)
{ head -1 two/scaling.csv
  for side in 20 30 40 60 80 100; do
    awk -v key="$key" -v side=$side 'BEGIN {
      t = 50 * exp(1.077 * 3 * log(side / 100)); if (side == 20) t *= 3
      printf "%s,%g,0,1,2,3,0.5,0,place,%.6f,%.6f,0,9\n", key, side, 0.25 * t, 0.5 * t
      printf "%s,%g,0,1,2,3,0.5,0,triangulate,%.6f,%.6f,0,9\n", key, side, 0.75 * t, 0.5 * t }'
  done
  tail -2 two/scaling.csv; } > planted/scaling.csv
expect 0 "" conceg bench scaling "$recipe" --threads 1 --until triangulate --sides 20,30,40,60,80,100,16:1 -o planted
expect_output "^wall time: V\^1\.077 \+- 0\.000 over 5 boxes from 30 um, 50 s at 100 um \(paper: V\^1\.077, 10800 s\)"
expect_output "^user CPU time: V\^1\.077 "
sed '3s/,place\|,triangulate/,/' planted/scaling.csv > damaged; mkdir spoilt; cp damaged spoilt/scaling.csv
expect 3 "scaling.csv:3: expected" conceg bench scaling "$recipe" --threads 1 --until triangulate --sides 20 -o spoilt
echo "not a table" > spoilt/scaling.csv
expect 3 "scaling.csv:1: expected a table" conceg bench scaling "$recipe" --threads 1 --until triangulate --sides 20 -o spoilt

# A stage that fails ends the bench; what was done stays.
expect 3 "place failed; the boxes that are done are kept" conceg bench scaling "$recipe" --threads 1 --until triangulate --sides 16:1,2:1 -o two -q
expect_true "the box that was done is kept" test "$(wc -l < two/scaling.csv)" -eq 3
expect_true "no document is left after a failure" sh -c '! ls -A two | grep -vE "^scaling\.(csv|json|svg)$"'
expect_done
