#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What a person at a terminal sees: no waiting for a document nobody types, no binary on the screen.  terminal.sh BIN PLUGINS
bin=$1 plugins=$2
command -v script > /dev/null || { echo "SKIPPED: the program script (bsdutils) is not here"; exit 77; }
script -qec true /dev/null > /dev/null 2>&1 < /dev/null || { echo "SKIPPED: no pseudo-terminal can be opened here"; exit 77; }
. "$(dirname "$0")/expect.sh"
t=$expect_folder
PATH=$bin:$PATH
CONCEG_STAGE_PATH=$plugins
export PATH CONCEG_STAGE_PATH
printf 'conceg: 1\ndomain:\n  size_um: [20, 20, 20]\nplace: {impl: toy}\n' > "$t/toy.yaml"
conceg place -p "$t/toy.yaml" -o "$t/toy.cgx" || exit 1

# on_terminal CODE REGEX COMMAND: runs a command with a terminal on all three streams.
on_terminal() {
  expect_count=$((expect_count + 1))
  script -qec "$3" "$t/typescript" > /dev/null 2>&1 < /dev/null
  got=$?
  if [ "$got" -ne "$1" ] || ! grep -qE "$2" "$t/typescript"; then
    expect_failed=$((expect_failed + 1))
    echo "FAILED: $3: expected exit code $1 and $2, got $got and"
    cat -v "$t/typescript"
  fi
}
on_terminal 2 "no input: name a .cgx file" "conceg info"
on_terminal 2 "usage: conceg relax" "conceg relax --impl beads -o $t/x.cgx"
on_terminal 2 "standard output is a terminal .*-o FILE" "conceg place -p $t/toy.yaml"
on_terminal 0 "CGX 1.0" "conceg info $t/toy.cgx"
expect_true "nothing was written" test ! -e "$t/x.cgx"
expect_done
