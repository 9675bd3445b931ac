#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Plugins: found by name, opened lazily, refused with file and numbers, kept to their contract.  plugins.sh BIN PLUGINS BAD
bin=$1 plugins=$2 bad=$3
. "$(dirname "$0")/../cli/expect.sh"
t=$expect_folder
conceg=$bin/conceg
PATH=$bin:$PATH
export PATH
printf 'conceg: 1\ndomain:\n  size_um: [20, 20, 20]\nplace: {impl: toy}\n' > "$t/toy.yaml"
CONCEG_STAGE_PATH=$plugins
export CONCEG_STAGE_PATH

# A source from a plugin, then stages from plugins.
expect 0 "" "$conceg" place -p "$t/toy.yaml" -o "$t/toy.cgx"
expect 0 "" "$conceg" validate "$t/toy.cgx"
expect 0 "" "$conceg" relax --impl beads "$t/toy.cgx" -o "$t/spheres.cgx"
expect 0 "" "$conceg" validate "$t/spheres.cgx"
expect 0 "" "$conceg" dump -g /provenance/implementation "$t/spheres.cgx"
expect_output '"beads"'
expect 0 "" "$conceg" dump -g /spheres "$t/spheres.cgx"
expect_output '/spheres@made_from text\[2\]: "cells=[0-9a-f]{64}" "skeleton=[0-9a-f]{64}"'

# The contract: what is stale goes, what is broken or undeclared is refused.
expect 5 "no implementation is named nobody" "$conceg" relax --impl nobody "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "relax \(broken\) wrote a broken group" "$conceg" relax --impl broken "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "wrote /volumes, which its descriptor does not list" "$conceg" relax --impl elsewhere "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "asked for the parameter \"no_such_row\"" "$conceg" relax --impl asking "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "relax \(silent\)" "$conceg" relax --impl silent "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "conceg relax: error: the toy exploded" "$conceg" relax --impl throwing "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "relax \(changing\): changed /cells, which its descriptor does not list" "$conceg" relax --impl changing "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "relax \(dropping\): dropped /cells, which its descriptor does not list" "$conceg" relax --impl dropping "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "relax \(forging\): dropped /provenance, which" "$conceg" relax --impl forging "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "relax \(nonsense\): returned 7, which is no status" "$conceg" relax --impl nonsense "$t/toy.cgx" -o "$t/x.cgx"
expect 1 "relax \(ending\) ended the program while it ran; nothing was written" "$conceg" relax --impl ending "$t/toy.cgx" -o "$t/x.cgx"
if "$conceg" version | grep -q sanitizer || nm -D "$conceg" 2> /dev/null | grep -q __asan_init; then echo "under a sanitizer: its own report stands for a crash"
else
  expect 1 "relax \(crashing\) crashed while it ran: signal 11; nothing was written" "$conceg" relax --impl crashing "$t/toy.cgx" -o "$t/x.cgx"
  expect 1 "relax \(thrown\) crashed while it ran: signal 6; nothing was written" "$conceg" relax --impl thrown "$t/toy.cgx" -o "$t/x.cgx"
  expect_true "CONCEG_CORE keeps the signal" sh -c "CONCEG_CORE=1 '$conceg' relax --impl crashing '$t/toy.cgx' -o '$t/x.cgx' 2> /dev/null; test \$? -eq 139"
fi
expect 0 "^a stage that prints$" "$conceg" relax --impl printing "$t/toy.cgx" -o "$t/printed.cgx"
expect 0 "" sh -c "'$conceg' relax --impl printing '$t/toy.cgx' > '$t/piped.cgx'"
expect_same "$t/printed.cgx" "$t/piped.cgx"
expect_true "a failed stage leaves no output" test ! -e "$t/x.cgx"
expect 3 "needs /skeleton, which the document does not have; run conceg grow before it" \
  sh -c "'$conceg' strip skeleton '$t/toy.cgx' | '$conceg' relax --impl beads -o '$t/x.cgx'"

# A group that is read where it is there may be absent; one that is needed may not.
expect 0 "" "$conceg" relax --impl modest "$t/toy.cgx" -o "$t/x.cgx"
rm "$t/x.cgx"

# A second run of what made a group makes its dependents stale: place again drops the spheres of the old skeleton.
"$conceg" relax --impl beads "$t/toy.cgx" -o "$t/spheres.cgx"
expect 0 "" "$conceg" run "$t/toy.yaml" --set 'stages=[place,relax]' --set relax.impl=beads -o "$t/both.cgx"

# Refused plugins.
CONCEG_STAGE_PATH=$bad
expect 5 "libconceg_stage_relax_wrongabi.so: built for stage ABI 2, this library has 1" "$conceg" relax --impl wrongabi "$t/toy.cgx" -o "$t/x.cgx"
expect 5 "libconceg_stage_relax_short.so: expected a descriptor of at least [0-9]+ bytes, got [0-9]+" "$conceg" relax --impl short "$t/toy.cgx" -o "$t/x.cgx"
for fault in "twice:a name that no other row has" "beyond:a default that fits the row" "turned:a range with lo <= hi" \
  "shouting:a name of at most 64 lower-case letters" "typeless:a known type" "defaultless:a default that fits" "choiceless:choices" "endless:a table of at most 256 rows"; do
  expect 5 "libconceg_stage_relax_${fault%%:*}.so: parameter [0-9]+ \(.*\): expected ${fault#*:}" "$conceg" relax --impl "${fault%%:*}" "$t/toy.cgx" -o "$t/x.cgx"
done
expect 5 "libconceg_stage_relax_unsure.so: expected reads, writes and drops of at most 64 names of groups" "$conceg" relax --impl unsure "$t/toy.cgx" -o "$t/x.cgx"
expect 5 "libconceg_stage_relax_misnamed.so: by its file name expected the stage relax misnamed, got relax other" \
  "$conceg" relax --impl misnamed "$t/toy.cgx" -o "$t/x.cgx"
expect 5 "libconceg_stage_relax_garbage.so: cannot be opened" "$conceg" relax --impl garbage "$t/toy.cgx" -o "$t/x.cgx"
expect 5 "libconceg_stage_relax_nosymbol.so: has no symbol conceg_stage_entry" "$conceg" relax --impl nosymbol "$t/toy.cgx" -o "$t/x.cgx"
expect 0 "" "$conceg" stages
expect_output "cannot be used: .*wrongabi"
expect 0 "" "$conceg" stages --json

# Search order: the first folder that has the file answers; an empty element is the install folder.
mkdir "$t/first" && cp "$plugins/libconceg_stage_relax_beads.so" "$t/first/"
CONCEG_STAGE_PATH=:$t/first:$plugins:$t/missing
expect 0 "" "$conceg" stages
expect_output "relax +beads +1.0.0 +$t/first/"
expect_done
