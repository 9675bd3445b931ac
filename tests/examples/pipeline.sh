#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The examples on tissue that the pipeline made.  pipeline.sh SOURCE BUILD LIBRARIES
source=$1 build=$2 libraries=$3
. "$source/tests/cli/expect.sh"
t=$expect_folder
if ! "$build/bin/conceg" stages | grep -q '^mesh '; then
  echo "SKIPPED: no mesh stage in this build: the examples were not run on tissue of the pipeline"
  exit 77
fi
expect 0 "" "$build/bin/conceg" run "$source/tests/pipe/small.yaml" --until mesh -q -o "$t/small.cgx"
expect 0 "" "$build/tests/examples_random_walk" "$t/small.cgx" 1000 100
expect_output '^leaks 0 of 2000$'
expect_output '^soma: walkers [1-9]'
expect_output '^basal dendrite: walkers [1-9]'
expect 0 "" "$build/tests/examples_inspect" "$t/small.cgx" 100000
expect_output 'points: agree$'
python=${CONCEG_PYTHON:-python3}
if command -v "$python" > /dev/null && [ -n "$libraries" ]; then
  expect 0 "" "$python" "$source/apps/examples/substrate.py" "$t/small.cgx" --lib "$libraries"
  expect_output 'somas located in their own cells 3'
fi
expect_done
