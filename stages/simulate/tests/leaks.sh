#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# 1e9 steps in and between the cells of the default recipe: no walker leaks.  leaks.sh BIN SOURCE
set -eu
PATH=$1:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
conceg run "$2/apps/recipes/cube.yaml" --until mesh -q -o "$work/cube.cgx"
conceg simulate "$work/cube.cgx" --walkers 40000 --b 1 --directions 1 -o "$work/simulated.cgx" 2> "$work/log"
cat "$work/log"
tail -n 1 "$work/log" | grep -q 'leaks: 0$'
conceg dump /walkers "$work/simulated.cgx" | grep -E '@(leaks|retractions|steps)'
