#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every public header compiles alone as C11 and as C++17, pedantic, without a warning.  headers.sh SOURCE CC CXX
source=$1 cc=$2 cxx=$3
count=0 failed=0
for header in "$source"/libconceg/include/conceg/*.h; do
  name=conceg/$(basename "$header")
  count=$((count + 1))
  echo "#include \"$name\"" | "$cc" -std=c11 -pedantic -Wall -Wextra -Wshadow -Werror -fsyntax-only -I"$source/libconceg/include" -x c - ||
    { echo "$name: not C11 by itself"; failed=$((failed + 1)); }
  echo "#include \"$name\"" | "$cxx" -std=c++17 -pedantic -Wall -Wextra -Wshadow -Werror -fsyntax-only -I"$source/libconceg/include" -x c++ - ||
    { echo "$name: not C++17 by itself"; failed=$((failed + 1)); }
done
echo "$count headers, $failed failures"
[ "$count" -ge 14 ] && [ "$failed" -eq 0 ]
