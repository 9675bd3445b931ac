#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shared library shows conceg_* and nothing else.  symbols.sh LIBRARY
symbols=$(nm -D --defined-only "$1") || exit 1
count=$(echo "$symbols" | grep -c ' [TDBRV] conceg_')
others=$(echo "$symbols" | grep -v ' conceg_' | grep -v ' A CONCEG_')
if [ -n "$others" ]; then
  echo "symbols that do not begin with conceg_:"
  echo "$others"
  exit 1
fi
echo "$count symbols, all conceg_*"
[ "$count" -ge 60 ]
