#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The page of a document from the command line: names, exit codes, same bytes, documents that lack parts.  report.sh BIN
bin=$1
source=$(cd -- "$(dirname -- "$0")/../.." && pwd)
. "$(dirname "$0")/expect.sh"
PATH=$bin:$PATH
export PATH
for stage in report import place; do
  [ -x "$bin/conceg-$stage" ] || { echo "SKIPPED: this build has no $stage stage"; exit 77; }
done
cd "$expect_folder" || exit 1

cat > cell.swc <<TEXT
1 1 0 0 0 5 -1
2 3 5 0 0 1 1
3 3 20 5 0 0.7 2
4 3 30 12 4 0.4 3
5 3 30 -2 4 0.4 3
TEXT
expect 0 "" conceg import swc cell.swc -q -o swc.cgx
expect 0 "" conceg place -p "$source/tests/pipe/small.yaml" -q -o placed.cgx

# -o with a page names the page, with a document passes the document on; --page always names the page.
expect 0 "wrote one.html" conceg report swc.cgx -o one.html
expect 0 "" conceg report swc.cgx -q --page two.html
expect_same one.html two.html
expect 0 "" conceg report swc.cgx -q --page three.html -o three.cgx
expect_same one.html three.html
expect 0 "" conceg report swc.cgx -q -o passed.cgx
expect_same one.html report.html
rm report.html
expect 0 "" conceg diff swc.cgx passed.cgx
expect 0 "" sh -c "conceg report -q --page piped.html < swc.cgx"
expect_same one.html piped.html
expect 0 "" conceg report swc.cgx -q
expect_same one.html report.html
expect 0 "" conceg report swc.cgx -q -o "a: b.html"
expect_same one.html "a: b.html"
for threads in 1 3; do
  expect 0 "" conceg report swc.cgx -q --threads $threads -o threads.html
  expect_same one.html threads.html
done

# What it needs is on the page, and the page asks for nothing else.
expect 0 "" grep -q "default-src 'none'" one.html
expect 0 "" sh -c "sed 's/<!--.*-->//' one.html | grep -q 'id=\"run-position\"'"
expect 1 "" sh -c "grep -oE '<(link|img|iframe|script)[^>]*(src|href)=[^>]*>' one.html || { echo 'error: none' >&2; exit 1; }"

# Documents that lack parts, or everything.
expect 0 "" conceg report placed.cgx -q -o placed.html
expect 0 "" sh -c "conceg strip cells,types,domain,skeleton swc.cgx | conceg report -q --page little.html"
expect 0 "" grep -q '"cells":0' little.html
# A small page says what it leaves out.
awk 'BEGIN { print "1 1 0 0 0 5 -1"; for (i = 2; i < 2000; i++) print i, 3, 5 + i / 50, 0, 0, 0.5, i - 1 }' > long.swc
expect 0 "" conceg import swc long.swc -q -o long.cgx
expect 0 "Of 1998 skeleton points [0-9]* are drawn: one per [0-9.]* um" conceg report long.cgx -v --size-mb 0.01 --page small.html
expect 0 "" grep -q "Of 1998 skeleton points" small.html
expect 0 "" conceg report swc.cgx -q --rows 1 --page rows.html

expect 4 "nowhere.cgx" conceg report nowhere.cgx -o none.html
expect 4 "/nowhere/.*No such file or directory" conceg report swc.cgx -o /nowhere/none.html
expect 2 "page: expected the name of a file" conceg report swc.cgx --page ""
expect 2 "size_mb" conceg report swc.cgx --size-mb 0 -o none.html
expect 2 "rows" conceg report swc.cgx --rows 0 -o none.html
echo "no document" > no.cgx
expect 3 "no.cgx" conceg report no.cgx -o none.html
expect 3 "the program before this one wrote nothing" sh -c "true | conceg report -o none.html"
mkdir folder.html
expect 4 "folder.html" conceg report swc.cgx -o folder.html
expect 0 "" test ! -e none.html
expect 0 "" sh -c '! ls -A | grep -q "^\.conceg"'
expect_done
