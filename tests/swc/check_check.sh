#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# conceg swc check as a user meets it: lines, verdicts, summary, JSON, exit codes.  check_check.sh BIN MAKER TABLE FIXTURES
bin=$1 maker=$2 table=$3 fixtures=$4
PATH=$bin:$PATH
. "$(dirname "$0")/../cli/expect.sh"
t=$expect_folder
mkdir -p "$t/cases/below/deeper"
"$maker" "$table" "$fixtures" "$t/cases" > /dev/null || { echo "FAILED: the cases could not be written"; exit 1; }
cases=$(ls "$t/cases" | grep -c '\.swc$')

# The verdicts of the whole table, as the table has them (cases with options are read without).
refused=$(grep -v '^#' "$table" | awk -F '\t' '$6 == "refused"' | wc -l)
split=$(grep -v '^#' "$table" | awk -F '\t' '$3 ~ /split/' | wc -l)
strict=$(grep -v '^#' "$table" | awk -F '\t' '$6 != "refused" && $3 !~ /split/ && $5 ~ /!/' | wc -l)
expect 3 "error: $((refused + split)) of $cases files refused" conceg swc check "$t/cases"
expect_output "^$cases files read: $((cases - refused - split)) accepted, $((refused + split)) refused; errors: .*warnings: "
expect 3 "" conceg swc check --strict "$t/cases"
expect_output "^$cases files read strictly: $((cases - refused - split - strict)) accepted, $((refused + split + strict)) refused"
expect 3 "" conceg swc check --somata=split "$t/cases"
expect_output "^$cases files read: $((cases - refused + 1)) accepted, $((refused - 1)) refused"

# Lines, in the order of the file.
printf '1 1 0 0 0 5 -1\n2 3 6 0 0 0 1\n3 3 9 0 0 1 77\n' > "$t/one.swc"
expect 0 "" conceg swc check "$t/one.swc"
expect_output "^$t/one.swc:2: W_RADIUS: "
expect_output "^$t/one.swc:3: W_ORPHAN: no sample has the id 77"
expect_output "^$t/one.swc: accepted, 3 warnings, 2 samples, soma: point"
expect_output "^1 files read: 1 accepted, 0 refused; warnings: W_RADIUS 1, W_ORPHAN 1, W_POINT 1"
expect 3 "1 of 1 files refused" conceg swc check --strict "$t/one.swc"
expect_output "^$t/one.swc: REFUSED, 1 errors"
expect 0 "" conceg swc check -q "$t/one.swc"
expect_true "-q says nothing of a good file" test ! -s "$t/stdout"
expect 0 "" conceg swc check --floating=drop "$t/one.swc"
expect_output "1 samples"

# Folders, below and with other endings; a file is read whatever its name.
cp "$t/one.swc" "$t/cases/below/deeper/one.SWC"
cp "$t/one.swc" "$t/cases/below/notes.txt"
ln -s .. "$t/cases/below/round"
expect 0 "" conceg swc check "$t/cases/below"
expect_output "^1 files read: 1 accepted"
expect 0 "" conceg swc check "$t/cases/below/notes.txt" "$t/one.swc"
expect_output "^2 files read: 2 accepted"
mkdir "$t/none"
expect 3 "no file whose name ends in .swc" conceg swc check "$t/none"
expect 4 "1 of 2 files could not be read" conceg swc check "$t/one.swc" "$t/absent.swc"
expect_output "^NOT READ: $t/absent.swc: "
expect 2 "which files" conceg swc check
expect 2 "expected keep, drop or attach" conceg swc check --floating=burn "$t/one.swc"
expect 2 "expected check or repair" conceg swc mend
expect 0 "" conceg swc --help

# JSON holds the same.
expect 3 "" conceg swc check --json --strict "$t/one.swc"
expect_output '"line":3,"code":"W_ORPHAN"'
expect_output '"accepted":false'
expect_output '"read":1,"accepted":0,"refused":1'
if [ -x "${CONCEG_PYTHON:-}" ] || CONCEG_PYTHON=$(command -v python3); then
  expect_true "the output is JSON" "$CONCEG_PYTHON" -m json.tool "$t/stdout"
fi
expect_done
