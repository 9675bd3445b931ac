#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# One stage of the pipe is replaced by a shell script that obeys spec/stream.md, put earlier in PATH.
. "$(dirname -- "$0")/common.sh"
recipe=$root/tests/pipe/small.yaml

mkdir mine
cat >mine/conceg-relax <<'SCRIPT'
#!/bin/sh
# A third party's relax: takes the document from standard input and gives it back as it came (no packing wanted).
set -eu
document=$(mktemp)
trap 'rm -f "$document"' EXIT
cat >"$document"
[ -s "$document" ] || { echo "conceg-relax: the program before this one wrote nothing" >&2; exit 3; }
conceg validate -q "$document" || exit 3
echo "replaced" >>"$REPLACED"
cat "$document"
SCRIPT
chmod +x mine/conceg-relax
REPLACED=$scratch/replaced
export REPLACED
conceg run "$recipe" --until grow -q -o grown.cgx
PATH=$scratch/mine:$PATH
{ conceg relax -q <grown.cgx || echo relax >failed; } | { conceg mesh -q >meshed.cgx || echo mesh >>failed; }
check "the pipe with the script runs" test ! -s failed
check "the script was asked" test -s replaced
check "the result is valid" conceg validate -q meshed.cgx
conceg dump /skeleton grown.cgx >before.txt
conceg dump /skeleton meshed.cgx >after.txt
check "the skeleton is the one that grow made" cmp before.txt after.txt
check_not "the script refuses an empty pipe" sh -c 'conceg relax </dev/null >/dev/null 2>&1'
done_checking
