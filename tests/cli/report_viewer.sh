#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The viewer that is committed is what its sources make, byte for byte.  report_viewer.sh SOURCE
viewer=$1/stages/report/viewer
command -v node > /dev/null || { echo "SKIPPED: no node: the committed viewer is not made anew"; exit 77; }
[ -d "$viewer/node_modules/esbuild" ] || { echo "SKIPPED: stages/report/viewer/build.sh was not run here: the committed viewer is not made anew"; exit 77; }
t=$(mktemp -d) || exit 1
trap 'rm -rf "$t"' EXIT
node "$viewer/build.mjs" "$t" || { echo "FAILED: build.mjs"; exit 1; }
for file in viewer.html THIRD-PARTY.txt; do
  cmp "$t/$file" "$viewer/dist/$file" || { echo "FAILED: $file is not what its sources make: run stages/report/viewer/build.sh"; exit 1; }
done
echo "2 files are what their sources make"
