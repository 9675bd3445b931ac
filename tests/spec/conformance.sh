#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The corpus is what its generator makes, each document gets its verdict, and every problem says rule, path, expected and got.
#   conformance.sh BIN ROOT TESTS            checks
#   conformance.sh BIN ROOT TESTS . --update writes the corpus of the checkout again
[ "${4-}" = . ] && update=${5-} || update=
. "$(dirname -- "$0")/../pipe/common.sh"
made=$3 corpus=$root/spec/conformance
twins() { for f in "$1"/passed/*.cgx; do conceg dump "$f" >"${f%.cgx}.txt" || return 1; done; }
if [ "$update" = --update ]; then
  rm -f "$corpus"/*/*.cgx "$corpus"/*/*.txt
  "$made/test_corpus" "$corpus" && twins "$corpus"
  exit
fi

mkdir again
check "the corpus is made again" "$made/test_corpus" "$scratch/again"
check "dump of each passed document" twins again
check "the same bytes and text twins" diff -r -x README.md again "$corpus"
for f in "$corpus"/*/*.cgx; do sha256sum "$f"; done >before
check "every verdict is as expected" conceg validate -q --expect "$corpus/manifest.tsv"
for f in "$corpus"/*/*.cgx; do sha256sum "$f"; done >after
check "input is never changed" cmp before after

# Planted defects: another rule, another verdict, another exit code, a line cut short.
cp -r "$corpus" wrong
planted() { # planted WORDS EXIT SED
  sed "$3" "$corpus/manifest.tsv" >wrong/manifest.tsv
  code=0; conceg validate --expect wrong/manifest.tsv >out 2>&1 || code=$?
  check "planted $3: exit $2, got $code" [ "$code" = "$2" ]
  check "planted $3: the line" grep -q "$1" out
}
planted "failed/0310-zero-radius.cgx: expected invalid CGX-032, exit 3; got invalid CGX-031, exit 3" 1 's/\(0310.*\)CGX-031/\1CGX-032/'
planted "passed/0003-box.cgx: expected invalid -, exit 0; got valid" 1 's/\(0003-box.cgx\t\)valid/\1invalid/'
planted "stream/0002-text.cgx: expected not-a-document CGX-001, exit 4" 1 's/\(0002-text.*CGX-001\t\)3/\14/'
planted "manifest.tsv:3: expected five columns" 3 's/^\(passed.0001[^\t]*\)\t/\1 /'
check "the count of deviants" sh -c 'sed "s/\(0310.*\)CGX-031/\1CGX-032/" "$1" >wrong/manifest.tsv; conceg validate --expect wrong/manifest.tsv | grep -q " 1 not;"' sh "$corpus/manifest.tsv"

# The form of every line, as text and as JSON.
for f in "$corpus"/failed/*.cgx "$corpus"/stream/*.cgx; do
  code=0; conceg validate "$f" >lines 2>/dev/null || code=$?
  check "$f: exit 3" [ "$code" = 3 ]
  check "$f: rule, path, expected, got" grep -Eq '^error CGX-[0-9]{3} /[^ ]*( [^:]*)?: expected .+, got .+' lines
  check_not "$f: no line of another form" sh -c 'grep -Ev "^(error|warning) CGX-[0-9]{3} /.*: expected .+, got .+|: NOT VALID: " lines >/dev/null'
done
conceg validate --json "$corpus/failed/0300-nan.cgx" >json || true
check "the index as numbers" grep -q '"path":"/cells/soma\[1,2\]","index":\[1,2\]' json

# The same verdict through a pipe as from a file.
for f in "$corpus"/stream/*.cgx; do
  code=0; cat "$f" | conceg validate - >piped 2>/dev/null || code=$?
  check "$f: exit 3 through a pipe" [ "$code" = 3 ]
  rule=$(awk -F '\t' -v name="stream/${f##*/}" '$1 == name { print $3 }' "$corpus/manifest.tsv")
  check "$f: $rule through a pipe" grep -q "^error $rule " piped
done

# What is not known is carried through a program: all but the group that was taken away is as before.
for f in "$corpus"/roundtrip/*.cgx; do
  conceg strip / "$f" -o carried.cgx
  conceg strip / carried.cgx -o twice.cgx
  check "$f: carried twice is the same" cmp carried.cgx twice.cgx
  case $f in *compound*) ;; # which diff cannot compare; spec.foreign reads them
  *) check "$f: nothing is lost" conceg diff -q --exact "$f" carried.cgx ;;
  esac
  conceg strip domain "$f" -o stripped.cgx
  conceg strip domain stripped.cgx -o again.cgx 2>/dev/null && check "$f: domain is gone" false
  for group in x_lab future cells/x_lab_colour; do
    conceg dump "/$group" "$f" >one 2>/dev/null || continue
    conceg dump "/$group" stripped.cgx >two
    check "$f: $group is carried through" cmp one two
  done
done
check "several files on one line" conceg validate -q "$corpus"/passed/0001*.cgx "$corpus"/passed/0003*.cgx
check_not "one bad file among several" sh -c 'conceg validate -q "$1"/passed/0001*.cgx "$1"/failed/0310*.cgx "$1"/passed/0003*.cgx >/dev/null' sh "$corpus"
done_checking
