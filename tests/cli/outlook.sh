#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# conceg run looks ahead: room on disk before anything that takes long, and the time that is left of the whole run.  outlook.sh BIN SOURCE
. "$(dirname -- "$0")/../pipe/common.sh"
recipe=$root/tests/pipe/small.yaml

# Petabytes of faces: refused after place, with what is needed where and by whom.
big="--set domain.size_um=[200,200,200] --set mesh.h_um=0.01"
code=0
conceg run "$recipe" $big --checkpoint saved -o big.cgx > out 2> error || code=$?
check "exit code 4" test "$code" = 4
check "the line names folder, need, parts and remedies" grep -qE '^conceg run: error: [^:]*: this run needs about [0-9.]+ GB of disk there \(.*of temporary files in /.*, .* of checkpoints in saved, .* of the document in \.\), [0-9.]+ [GM]B are free; .*TMPDIR.*mesh\.h_um.*--ignore-space$' error
check "place alone has run" sh -c 'test "$(ls saved)" = 01-place.cgx && test ! -e big.cgx'
# A run that fits is not held up, and needs no override.
check "a run that fits" conceg run "$recipe" --set mesh.h_um=0.6 --until mesh --progress=json -o small.cgx 2> log

# The time left of the run stands in every line of progress once place has said what is asked for.
check "lines of progress have it" grep -qE '"progress":"[^"]*","done":[0-9]+,"total":[0-9]+,"seconds":[0-9.]+,"run_seconds_left":[0-9]+}' log
check "not before place is done" sh -c '! sed "/stage.:.triangulate/,\$d" log | grep -q run_seconds_left'
first=$(grep -o 'run_seconds_left":[0-9]*' log | head -n 1 | cut -d: -f2) last=$(grep -o 'run_seconds_left":[0-9]*' log | tail -n 1 | cut -d: -f2)
check "it falls: $first, at last $last s" test "$last" -le "$first"
# A long run says so at each stage; passed over, the want of room does not hold it up.
conceg run "$recipe" $big --ignore-space -o big.cgx 2> log &
child=$!
for _ in $(seq 600); do
  ! grep -q 'stage 2 of 6' log || break
  sleep 0.1
done
kill -KILL "$child" 2> /dev/null || true
wait "$child" 2> /dev/null || true
check "a line as a stage begins" grep -qE '^conceg run: stage 2 of 6, triangulate: about [0-9.]+ (min|h) left of the run \(by the weights of the stages\)$' log
done_checking
