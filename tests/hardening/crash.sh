#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A crash inside HDF5 becomes an error line and exit code 3.  crash.sh BIN LIBRARY PLUGINS
set -eu
bin=$1 library=$2
export CONCEG_STAGE_PATH=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
printf 'conceg: 1\ndomain: {size_um: [10, 10, 10]}\nseed: 1\n' >a.yaml
"$bin/conceg" place --impl toy -p a.yaml -o a.cgx
"$bin/conceg" info a.cgx >/dev/null || { echo "the document is not good before the crash"; exit 1; }
checks=0
for signal in 11 6 7 8; do
  for tool in info validate dump "diff a.cgx" "relax --impl beads -o b.cgx"; do
    code=0
    CRASH_SIGNAL=$signal LD_PRELOAD=$library "$bin/conceg" $tool a.cgx >out 2>err || code=$?
    [ "$code" = 3 ] || { echo "$tool, signal $signal: expected exit code 3, got $code"; cat err; exit 1; }
    grep -q "error: a.cgx: damaged: the program crashed while it read the document: signal $signal" err ||
      { echo "$tool, signal $signal: the message does not say it"; cat err; exit 1; }
    [ ! -e b.cgx ] || { echo "$tool: something was written"; exit 1; }
    checks=$((checks + 1))
  done
  code=0
  CRASH_SIGNAL=$signal LD_PRELOAD=$library "$bin/conceg" info <a.cgx >out 2>err || code=$?
  [ "$code" = 3 ] && grep -q "standard input: damaged" err || { echo "standard input: got $code"; cat err; exit 1; }
  checks=$((checks + 1))
done
# Whoever wants the core gets the signal.
code=0
CONCEG_CORE=1 LD_PRELOAD=$library "$bin/conceg" info a.cgx >out 2>err || code=$?
[ "$code" -gt 128 ] || { echo "CONCEG_CORE: expected a signal, got $code"; exit 1; }
echo "$checks crashes became exit code 3, one kept its signal"
