#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every MUST rule of the specifications has a document that breaks it, or, where it speaks of programs, a named test.
. "$(dirname -- "$0")/../pipe/common.sh"
corpus=$root/spec/conformance
rules() { sed -n "s/^| \([CS][GT][XR]-[0-9]*\) | $1 |.*/\1/p" "$root/spec/cgx.md" "$root/spec/stream.md"; }
{ rules MUST; rules 'MUST, open'; } | sort >files_wanted
rules 'MUST, program' | sort >tests_wanted

# Rules of the first list that MANIFEST has no failing document for; of the second without a test.
without_file() {
  awk -F '\t' '$2 == "invalid" || $2 == "not-a-document" { print $3; while (match($5, /STR-[0-9]+/)) { print substr($5, RSTART, RLENGTH); $5 = substr($5, RSTART + RLENGTH) } }' "$1" | sort -u | comm -13 - files_wanted
}
without_test() { awk -F '\t' '$2 == "test" { print $3 }' "$1" | sort -u | comm -13 - tests_wanted; }
none() { [ -z "$2" ] || { printf '%s: %s\n' "$1" "$(echo $2)" >&2; return 1; }; }
check "rules were found" sh -c '[ "$(wc -l <files_wanted)" -ge 30 ] && [ "$(wc -l <tests_wanted)" -ge 15 ]'
check "rules without a failing document" none "without a document" "$(without_file "$corpus/manifest.tsv")"
check "rules without a test" none "without a test" "$(without_test "$corpus/manifest.tsv")"

# The tests that are named are there.
awk -F '\t' '$2 == "test" { print $5 }' "$corpus/manifest.tsv" | sort -u >named
while read -r name; do
  check "the test $name" grep -qw -- "${name#*.}" "$root/tests/${name%%.*}/CMakeLists.txt"
done <named

# Every rule and every file of the manifest is there, and every file is in the manifest.
awk -F '\t' '!/^#/ && $3 != "-" { print $3 }' "$corpus/manifest.tsv" | sort -u >used
while read -r rule; do
  check "$rule is a rule" grep -q "^| $rule |" "$root/spec/cgx.md" "$root/spec/stream.md"
done <used
awk -F '\t' '!/^#/ && $1 != "-" { print $1 }' "$corpus/manifest.tsv" | sort >listed
(cd "$corpus" && ls */*.cgx) | sort >there
check "the manifest lists each file once" cmp listed there
check "no file of 30 kB or more" [ -z "$(find "$corpus" -name '*.cgx' -size +29k)" ]

# Planted: a manifest without the documents of one rule, and without one test.
sed '/CGX-041/d; /STR-025/d' "$corpus/manifest.tsv" >thin.tsv
check "a rule without a document is found" [ "$(without_file thin.tsv)" = CGX-041 ]
check "a rule without a test is found" [ "$(without_test thin.tsv)" = STR-025 ]
printf '%s rules with documents, %s with tests\n' "$(wc -l <files_wanted)" "$(wc -l <tests_wanted)"
done_checking
