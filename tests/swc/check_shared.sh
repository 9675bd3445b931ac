#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every real SWC file of the shared folder is accepted, all but one strictly, and all can be repaired.
# check_shared.sh BIN MAKER TABLE FIXTURES
PATH=$1:$PATH
. "$(dirname "$0")/../cli/expect.sh"
t=$expect_folder shared=${CONCEG_SHARED:-}
[ -d "$shared/morphologies" ] && [ -d "$shared/goldens" ] || { echo "SKIPPED: CONCEG_SHARED has no morphologies and goldens: no real cells"; exit 77; }
files=$(find "$shared/morphologies" "$shared/goldens" -type f -name '*.swc' | wc -l)
expect_true "the 151 files known are there" test "$files" -ge 151
expect 0 "" conceg swc check "$shared/morphologies" "$shared/goldens"
expect_output "^$files files read: $files accepted, 0 refused"
tail -1 "$t/stdout"
expect 3 "1 of $files files refused" conceg swc check --strict "$shared/morphologies" "$shared/goldens"
expect_output "C_149.CNG_clean_alt.swc:2: W_PROSE: "
expect 0 "" conceg swc repair "$shared/morphologies" -o "$t/out" --radius-min 0.05 --floating=attach
grep -h ' rows = ' "$t/stdout" | sed 's/.*: \([0-9]* rows = \)/\1/' |
  awk '{ sum = 0; for (i = 4; i <= NF; i++) if ($i ~ /^[0-9]+$/) sum += $i; if (sum != $1) bad = 1 } END { exit bad || !NR }' ||
  { echo "FAILED: rows are not accounted for"; expect_failed=$((expect_failed + 1)); }
expect 0 "" conceg swc check --strict "$t/out"
expect_output "^[0-9]* files read strictly: [0-9]* accepted, 0 refused; warnings: (W_NO_SOMA|W_TYPECHANGE) [0-9]*, (W_NO_SOMA|W_TYPECHANGE) [0-9]*$"
expect_done
