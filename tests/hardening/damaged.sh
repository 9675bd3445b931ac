#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Documents that crashed HDF5 1.10 when its memory is watched (attribute) or hung it (heap): a plain program says what is wrong and ends with 3.
# damaged.sh BIN SOURCE
bin=$1 source=$2
. "$source/tests/cli/expect.sh"
for file in "$source"/tests/hardening/damaged/*.cgx; do
  for word in info validate dump; do
    expect 3 "$(basename "$file"): " "$bin/conceg" $word "$file"
  done
  expect 3 "standard input: " sh -c "cat '$file' | '$bin/conceg' strip cells -o '$expect_folder/x.cgx'"
  expect_true "nothing was written" test ! -e "$expect_folder/x.cgx"
done
expect_done
