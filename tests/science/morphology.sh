# SPDX-License-Identifier: BSD-3-Clause
# characterise on the golden cells beside TMD and NeuroM, which measure the same files in the same run. Nothing is cleaned.
. "$(dirname -- "$0")/../pipe/common.sh"
python=${CONCEG_PYTHON:-python3} goldens=${CONCEG_SHARED:-}/goldens/morphology
[ -f "$goldens/neurom_simple.swc" ] || skip "no golden cells in CONCEG_SHARED: barcodes and features are not compared with TMD and NeuroM"
"$python" -c 'import importlib.util, sys; sys.exit(not all(map(importlib.util.find_spec, ("h5py", "morphio", "neurom", "tmd"))))' 2>/dev/null ||
  skip "no Python with h5py, NeuroM and TMD: barcodes and features are not compared with theirs"
compare() { "$python" "$root/tests/science/morphology_peers.py" "$@"; }
whole="--axons=true --twig_length_um=0 --tree_length_um=0.001 --metrics=read"
check "barcodes are TMD's, features NeuroM's" compare "$whole" "$goldens"/*.swc
# Planted: branches taken off, and radii raised, must be seen by the one and the other.
differs() { compare "$1" "$goldens/sonata_pvalb_469628681.swc" >log && return 1; grep -q "^differs: .*$2" log; }
check "missing branches are found" differs "$whole --twig_length_um=100 --twig_radius_um=1" "bars of each tree"
check "thicker branches are found" differs "$whole --metrics=cleaned --lowest_radius_um=0.3" "all: volume"
# The goldens that C++ tests read are what their producers give today; one that is off must be found.
remake() { "$python" "$root/tests/science/remake_goldens.py" "$@"; }
if [ -f "$CONCEG_SHARED/morphologies/mouse_vis_L4_pyr/313862022.swc" ]; then
  check "goldens are NeuroM's and TMD's" remake "$CONCEG_SHARED"
  sed '/L4_pyramidal/s/\t3\./\t4./' "$root/stages/characterise/tests/default_dictionary.tsv" >planted.tsv
  planted() { remake --table planted.tsv "$CONCEG_SHARED" >log && return 1; grep -q '^differs: .*L4_pyramidal' log; }
  check "another golden is found" planted
fi
done_checking
