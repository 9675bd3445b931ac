#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Repaired files load in MorphIO, NeuroM and navis with the same samples, radii and lengths.
# check_peers.sh BIN MAKER TABLE FIXTURES
PATH=$1:$PATH
. "$(dirname "$0")/../cli/expect.sh"
t=$expect_folder here=$(dirname "$0") python=${CONCEG_PYTHON:-python3}
"$python" -c 'import importlib.util, sys; sys.exit(not all(map(importlib.util.find_spec, ("morphio", "navis", "neurom"))))' 2> /dev/null || { echo "SKIPPED: no Python with morphio, neurom and navis: repaired files are not read by others"; exit 77; }
mkdir "$t/cases"
"$2" "$3" "$4" "$t/cases" > /dev/null || { echo "FAILED: the cases could not be written"; exit 1; }
golden=${CONCEG_SHARED:-}/goldens/morphology/sonata_pvalb_469628681.swc
if [ -f "$golden" ]; then cp "$golden" "$t/cases"; fi
conceg swc repair "$t/cases" -o "$t/out" --radius-min 0.05 --floating=attach --somata=split > "$t/log" 2>&1
# MorphIO reads only the soma of a file with bare CR: a check that passes it would find nothing.
expect 0 "" "$python" "$here/peers.py" "$t/out" "$t/cases/2-cr_only.swc"
expect_output "^[0-9]+ files before MorphIO, NeuroM, navis: 0 failures"
cat "$t/stdout"
expect_done
