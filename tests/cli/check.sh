#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# conceg check as a user meets it: exit codes, lines, JSON, files and streams, the gates kept in a document, and in a run. Planted defects: unit.mesh_gates.  check.sh BIN
bin=$1
. "$(dirname "$0")/expect.sh"
source=$(CDPATH= cd -- "$(dirname "$0")/../.." && pwd)
PATH=$bin:$PATH
export PATH
[ -x "$bin/conceg-mesh" ] || { echo "SKIPPED: this build has no mesh stage (libcgal-dev)"; exit 77; }
[ -x "$bin/conceg-triangulate" ] || { echo "SKIPPED: this build has no triangulate stage (CONCEG_GPL)"; exit 77; }
cd "$expect_folder" || exit 1

expect 0 "" conceg run "$source/tests/pipe/small.yaml" --until mesh --set mesh.h_um=0.4 -q -o cells.cgx
# Pieces that the coarse grid cuts off are the one thing wrong with these cells.
set -- --points 100000 --most-detached 0.05 --icvf-tolerance 0.02
expect 0 "" conceg check cells.cgx "$@"
expect_output '^passed +/meshes +no two cells cross +0 \(none\) +[0-9]+ pairs of faces in all images'
expect_output '^passed +/bars +cable asked for +[01]\.[0-9]+ \(at least 0.8\)'
expect_output '^void +/walkers +no walker leaks +- '
expect_output '^cells.cgx: sound: 3[0-9] gates passed, 0 failed, 3 void$'
conceg check cells.cgx "$@" --least-cable 1 --least-gap-um 0.5 > lines 2> errors
expect_true "exit code 1 when gates fail" test $? -eq 1
expect_true "a gap that is too small fails" grep -q '^failed  /meshes    gap ' lines
expect_true "and says where" grep -q 'narrow gap: cell' lines
expect_true "the count of failed gates" grep -q '^cells.cgx: NOT SOUND: .* 1 failed, 3 void$' lines
expect_true "a failed gate is no error of the program" test ! -s errors
conceg check cells.cgx "$@" --least-gap-um 0.5 -q > lines
expect_true "-q leaves failed gates and the count" sh -c 'test "$(wc -l < lines)" -eq 2'
expect 0 "" conceg check cells.cgx "$@" -q
expect_true "-q says nothing of a sound document" test ! -s stdout

expect 0 "" conceg check cells.cgx "$@" --json
expect_output '"gate": ?"no cell crosses its own image"'
expect_output '"sound": ?true'
if command -v python3 > /dev/null; then
  cp stdout gates.json
  expect_true "the JSON reads" python3 -c 'import json; g = json.load(open("gates.json")); assert g["failed"] == 0 and len(g["gates"]) == g["passed"] + g["void"]'
fi

expect 0 "" conceg check cells.cgx "$@" --points 1000 --icvf-tolerance 0.02
expect_output '^void +/meshes +volume fraction by points +- +1000 points tell'

# What is not there is void, not passed.
expect 0 "" conceg strip meshes,volumes cells.cgx -q -o bare.cgx
expect 0 "" conceg check bare.cgx
expect_output '^void +/meshes +closed +- +no /meshes'
expect 0 "" sh -c "conceg check < bare.cgx"
expect_output '^standard input: sound'
expect 0 "" conceg check bare.cgx cells.cgx "$@"
expect_output '^bare.cgx: sound'
expect_output '^cells.cgx: sound'

# The gates in a document, and in a run.
expect 0 "" conceg check cells.cgx "$@" -o kept.cgx
expect 0 "" conceg validate -q kept.cgx
expect 0 "" conceg dump /statistics/gates kept.cgx
expect_output 'no two cells cross'
sed 's/^mesh:.*/mesh: {h_um: 0.4, volumes: false}\nstages: [place, triangulate, grow, relax, mesh, check]\ncheck: {points: 100000, most_detached: 0.05, stop: true}/' "$source/tests/pipe/small.yaml" > gated.yaml
expect 0 "" conceg run gated.yaml -q -o gated.cgx
expect 1 "error: check: 1 of 3[0-9] gates failed" conceg run gated.yaml --set check.least_gap_um=0.5 -o stopped.cgx
expect 0 "" test ! -e stopped.cgx

# Refused.
echo no > text.cgx
expect 3 "text.cgx" conceg check text.cgx
expect 4 "absent.cgx" conceg check absent.cgx
expect 2 "least_cable" conceg check cells.cgx --least-cable 2
expect 2 "least_cabel" conceg check cells.cgx --least-cabel 1
expect 2 "-o" conceg check bare.cgx cells.cgx -o x.cgx
expect 0 "" conceg check --help
expect_output 'conceg check cube.cgx && echo sound'
expect_output 'least-cable|least_cable'
expect_done
