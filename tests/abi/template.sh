#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The template stage builds out of tree, against the build folder, and stands in for relax.  template.sh SOURCE BUILD PLUGINS CC
source=$1 build=$2 plugins=$3 cc=$4
. "$source/tests/cli/expect.sh"
t=$expect_folder
conceg=$build/bin/conceg
PATH=$build/bin:$PATH
export PATH
cp -r "$source/stages/template" "$t/mine"
cmake -S "$t/mine" -B "$t/built" -Dconceg_DIR="$build/cmake" -DCMAKE_C_COMPILER="$cc" > "$t/log" 2>&1 && cmake --build "$t/built" >> "$t/log" 2>&1 ||
  { cat "$t/log"; exit 1; }
expect_true "the plugin was built" test -f "$t/built/libconceg_stage_relax_template.so"

printf 'conceg: 1\ndomain:\n  size_um: [20, 20, 20]\nplace: {impl: toy}\n' > "$t/toy.yaml"
CONCEG_STAGE_PATH=$plugins
export CONCEG_STAGE_PATH
"$conceg" place -p "$t/toy.yaml" -o "$t/toy.cgx" || exit 1
"$conceg" relax --impl beads "$t/toy.cgx" -o "$t/spheres.cgx" || exit 1
CONCEG_STAGE_PATH=$t/built

# Another skeleton makes the spheres of the old one stale.
expect 0 "/spheres no longer matches /skeleton and is dropped" "$conceg" relax -v --impl template "$t/spheres.cgx" -o "$t/thin.cgx"
expect 3 "/spheres: the document does not have it" "$conceg" dump -g /spheres "$t/thin.cgx"

expect 0 "" "$conceg" relax --impl template --factor 0.8 "$t/toy.cgx" -o "$t/thin.cgx"
expect 0 "" "$conceg" validate "$t/thin.cgx"
expect 0 "" "$conceg" dump -g /skeleton/radius "$t/thin.cgx"
expect_output "^  0\.4$"
expect 0 "" "$conceg" dump -g /recipe "$t/thin.cgx"
expect_output "relax:.*factor: 0.8"
expect 2 "relax.factor: expected a number from 0.01" "$conceg" relax --impl template --factor 7 "$t/toy.cgx" -o "$t/x.cgx"
expect 0 "" "$conceg" stages
expect_output "relax +template +1.0.0 +$t/built/libconceg_stage_relax_template.so"
expect 0 "" "$conceg" help relax
expect_done
