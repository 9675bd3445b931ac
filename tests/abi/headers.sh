#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every public header compiles alone as C11 and as C++17, pedantic, without a warning.  headers.sh SOURCE CC CXX
source=$1 cc=$2 cxx=$3
count=0 failed=0
for header in "$source"/libconceg/include/conceg/*.h; do
  name=conceg/$(basename "$header")
  count=$((count + 1))
  echo "#include \"$name\"" | "$cc" -std=c11 -pedantic -Wall -Wextra -Wshadow -Wconversion -Werror -fsyntax-only -I"$source/libconceg/include" -x c - ||
    { echo "$name: not C11 by itself"; failed=$((failed + 1)); }
  echo "#include \"$name\"" | "$cxx" -std=c++17 -pedantic -Wall -Wextra -Wshadow -Wconversion -Werror -fsyntax-only -I"$source/libconceg/include" -x c++ - ||
    { echo "$name: not C++17 by itself"; failed=$((failed + 1)); }
done
# What no public header may hold: types whose size differs between machines or that belong to others.
plain=$(sed -e 's:/\*.*\*/::' -e '/\/\*/,/\*\//d' "$source"/libconceg/include/conceg/*.h)
for word in 'FILE *\*' 'hid_t' '\<long\>' ' : [0-9]* *;' 'yaml_'; do
  if echo "$plain" | grep -n "$word"; then echo "a public header says $word"; failed=$((failed + 1)); fi
done
for clang in clang clang-14; do
  command -v "$clang" > /dev/null || continue
  for header in "$source"/libconceg/include/conceg/*.h; do
    for language in c11:c c++17:c++; do
      echo "#include \"conceg/$(basename "$header")\"" | "$clang" -std=${language%:*} -pedantic -Wall -Wextra -Wshadow -Werror -fsyntax-only -I"$source/libconceg/include" -x ${language#*:} - ||
        { echo "$(basename "$header"): $clang refuses it as ${language%:*}"; failed=$((failed + 1)); }
    done
  done
  break
done
echo "$count headers, $failed failures"
[ "$count" -ge 14 ] && [ "$failed" -eq 0 ]
