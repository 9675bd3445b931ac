#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A section of a real volume of electron microscopy, drawn back to a fifth of extracellular space, gives the figures of data/em-volume/README.md.
. "$(dirname -- "$0")/../pipe/common.sh"
slices=${CONCEG_SHARED:-$root/../shared}/em/pinky40_slices_u16.npz
[ -r "$slices" ] || skip "no volume of electron microscopy at $slices: its extracellular space is not measured"
conceg import labels "$slices" --array xy_z128 --voxel-um 0.016,0.016,0.04 -q -o slice.cgx
conceg analyse slice.cgx --erode-to 0.2 --pores=true --paths=true --path-um 4 --points 0 -v -o measured.cgx 2>log
# within NAME COLUMN VALUE TOLERANCE: the figure of the row NAME of a table in the log
within() {
  awk -v name="$1" -v column="$2" -v value="$3" -v tolerance="$4" '
    / note: / { sub(/.* note: */, ""); gsub(/ \[[^]]*\]/, "") }
    { for (i = 1; i <= NF; i++) { if ($i == column) at = i; if ($i == name && at) { found = 1; d = $at - value; bad = d > tolerance || d < -tolerance; print name, column, $at } } }
    END { exit !found || bad }' log
}
check "the depth is printed" grep -q "erosion: 0.051[0-9] um off each membrane" log
check "share that is open" within centre_radius ecs_fraction 0.199 0.002
check "depth in the table" within centre_radius erosion 0.0515 0.0005
check "radius at the maxima" within centre_radius mean 0.0692 0.001
check "width of the gaps" within gap_width mean 0.1132 0.002
check "straightness, marched" within fast_marching straightness 0.948 0.005
check "straightness, in steps" within steps straightness 0.903 0.005
check_not "another radius is not taken" within centre_radius mean 0.08 0.001
conceg analyse slice.cgx --erode-to 0.2 --pores=true --paths=true --path-um 4 --points 0 --threads 1 -q -o alone.cgx
check "the same bytes with one thread" cmp measured.cgx alone.cgx
done_checking
