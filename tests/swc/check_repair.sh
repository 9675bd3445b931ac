#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# conceg swc repair over the reader's table and over damaged files: what it writes passes the strict check, what it does not is
# refused with a reason, and every row is accounted for.  check_repair.sh BIN MAKER TABLE FIXTURES
bin=$1 maker=$2 table=$3 fixtures=$4
PATH=$bin:$PATH
. "$(dirname "$0")/../cli/expect.sh"
t=$expect_folder
damaged=1000

# accounted_for LOG: in each line "N rows = a ... + b ... + ..." the parts make up N. Prints how many lines there are.
accounted_for() {
  grep -h ' rows = ' "$1" | sed 's/.*: \([0-9]* rows = \)/\1/' | awk '
    { all = $1; sum = 0; for (i = 4; i <= NF; i++) if ($i ~ /^[0-9]+$/) sum += $i; if (sum != all) { print "not accounted for: " $0; bad = 1 } }
    END { print NR " files accounted for"; exit bad }'
}

# repaired FOLDER OUT "stays" options...: strict check of what was written; only the codes of "stays" may be left.
repaired() {
  from=$1 to=$2 stays=$3
  shift 3
  conceg swc repair "$from" -o "$to" "$@" > "$t/log" 2> "$t/stderr"
  code=$?
  written=$(grep -c ': written as ' "$t/log") files=$(grep -c ' rows = ' "$t/log") refused=$(grep -c 'NOT REPAIRED' "$t/log")
  expect_true "there is something repaired" test "$files" -gt 0
  expect_true "exit code $code with $refused refused" test "$code" -eq $((refused ? 3 : 0))
  expect_true "each file is repaired or refused: $files + $refused of $(ls "$from" | wc -l)" \
    test $((files + refused)) -eq "$(ls "$from" | wc -l)"
  accounted_for "$t/log" > "$t/accounts" || { cat "$t/accounts"; expect_failed=$((expect_failed + 1)); }
  expect_true "all are accounted for" grep -q "^$files files accounted for" "$t/accounts"
  expect 0 "" conceg swc check --strict "$to"
  expect_output "^$written files read strictly: $written accepted, 0 refused"
  left=$(tail -1 "$t/stdout" | sed 's/.*refused//; s/.*warnings://' | tr ', ' '\n\n' | grep '^W_' | grep -vE "^($stays)$")
  expect_true "nothing but $stays is left, got: $left" test -z "$left"
}

mkdir "$t/cases" "$t/damaged"
"$maker" "$table" "$fixtures" "$t/cases" > /dev/null && "$maker" "$table" "$fixtures" "$t/damaged" $damaged > /dev/null ||
  { echo "FAILED: the cases could not be written"; exit 1; }
expect_true "there are $damaged damaged files" test "$(ls "$t/damaged" | wc -l)" -eq $damaged
asked='--radius-min 0.05 --floating=attach --somata=split'
repaired "$t/cases" "$t/kept" 'W_NO_SOMA|W_TYPECHANGE|W_FLOATING|W_POINT' --radius-min 0.05
# Coordinates of 1e300 um are read but not written.
expect_true "what the reader refuses is not repaired" test "$refused" -eq "$(grep -v '^#' "$table" | awk -F '\t' '$6 == "refused" || $3 ~ /split/ || $2 == "far_away"' | wc -l)"
repaired "$t/cases" "$t/joined" 'W_NO_SOMA|W_TYPECHANGE' $asked
# Without a soma there is nothing to join a single sample to: W_POINT.
repaired "$t/damaged" "$t/mended" 'W_NO_SOMA|W_TYPECHANGE|W_POINT' $asked
echo "damaged: $files repaired, $refused refused"
expect_true "a third of the damaged files can be repaired" test "$files" -ge $((damaged / 3))
repaired "$t/damaged" "$t/dropped" 'W_NO_SOMA|W_TYPECHANGE|W_POINT' --radius-min 0.05 --floating=drop --somata=first

# A repaired file needs no further repair: the same bytes.
mkdir "$t/again"
expect 0 "" conceg swc repair "$t/joined" -o "$t/again"
for file in "$t/joined"/*.swc; do expect_same "$file" "$t/again/$(basename "$file")"; done

# What it says, and what it refuses with which remedy.
in=$t/in.swc out=$t/out.swc
printf '# species mouse\n# caf\351\n1 1 0 0 0 5 -1\n2 12 6 0 0 0 1 7.5\n3 3 6 0 0 1 2\n4 3 9 0 0 1 3\n4 3 9 0 0 1 3\n5 2 90 0 0 1 -1\n' > "$in"
expect 3 "1 of 1 files not repaired" conceg swc repair "$in" -o "$out"
expect_output "^$in: NOT REPAIRED: line 4: W_RADIUS: --radius-min"
expect_true "nothing is written" test ! -e "$out"
expect 0 "" conceg swc repair "$in" -o "$out" --radius-min 0.05 --other-types 3
expect_output "^$in:4: W_TYPE: type 12 written as 3"
expect_output "^$in:4: W_RADIUS: radius 0 written as 0.05"
expect_output "^$in:5: W_ZEROLEN: lies on its parent in line 4; merged with it"
expect_output "^$in:7: W_DUP: "
expect_output "^$in:8: W_POINT: a single sample joined to nothing; kept"
expect_output "^$in: W_ENCODING: 1 bytes of comments that are not ASCII written as \\?"
expect_output "^$in: 6 rows = 3 samples written \\+ 1 of somas \\+ 1 copies \\+ 1 on their parent \\+ 0 of floating"
expect_output "^$in: written as $out: 3 samples, 1 soma; stays: W_POINT"
expect_true "comments are kept" grep -q '^# species mouse$' "$out"
expect_true "the extra column is kept" grep -q '^# @begin nodes columns=x,y,z,radius,column8$' "$out"
grep -v '^#' "$out" > "$t/rows"
printf '1 1 0.000000 0.000000 0.000000 5.000000 -1\n2 3 6.000000 0.000000 0.000000 0.050000 1\n3 3 9.000000 0.000000 0.000000 1.000000 2\n4 2 90.000000 0.000000 0.000000 1.000000 -1\n' > "$t/wanted"
expect_same "$t/rows" "$t/wanted"
expect 0 "" conceg swc repair "$in" -o "$out" --radius-min 0.05 --zero-length=keep
expect_output "^$in: 6 rows = 4 samples written "
printf '1 1 0 0 0 5 -1\n2 1 40 0 0 5 -1\n3 3 46 0 0 1 2\n' > "$in"
expect 3 "" conceg swc repair "$in" -o "$out"
expect_output "NOT REPAIRED: line 2: E_SOMATA: --somata=split writes"
expect 0 "" conceg swc repair "$in" -o "$t/cell.swc" --somata=split
expect_true "a file per cell" test -s "$t/cell-1.swc" -a -s "$t/cell-2.swc" -a ! -e "$t/cell.swc"
expect 0 "" conceg swc repair "$in" -o "$out" --somata=first
expect_output "^$in: 3 rows = 0 samples written \\+ 2 of somas .* \\+ 1 of other cells left out"
printf '1 1 0 0 0 5 -1\n2 3 6 0 0 1 3\n3 3 7 0 0 1 2\n' > "$in"
expect 3 "" conceg swc repair "$in" -o "$out"
expect_output "NOT REPAIRED: line 2: E_CYCLE"
printf '1 1 0 0 0 0 -1\n2 3 6 0 0 1 1\n' > "$in"
expect 3 "" conceg swc repair "$in" -o "$out"
expect_output "NOT REPAIRED: W_RADIUS: the soma has no radius"

# The input is only written to when -o names it, and then whole.
printf '1 1 0 0 0 5 -1\r2 3 6 0 0 1 1\r' > "$in"
cp "$in" "$t/before.swc"
expect 2 "which -o" conceg swc repair "$in"
expect_same "$in" "$t/before.swc"
expect 0 "" conceg swc repair "$in" -o "$in"
expect 0 "" conceg swc check --strict "$in"
expect 2 "it is a folder, expected a file" conceg swc repair "$in" -o "$t/cases"
expect 4 "cannot be opened" conceg swc repair "$t/absent.swc" -o "$out"
expect 4 "" conceg swc repair "$in" -o "$t/absent/out.swc"
expect 2 "expected a number of" conceg swc repair "$in" -o "$out" --radius-min -1
expect 2 "expected 0, 2, 3, 4 or 7" conceg swc repair "$in" -o "$out" --other-types 5
expect_done
