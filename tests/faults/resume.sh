#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# conceg run --checkpoint killed inside of the mesh stage and of simulate: --resume takes over what the stage had finished, and the document has
# the bytes of a run that nobody killed. A run without --resume begins anew.  resume.sh BIN SOURCE
. "$(dirname -- "$0")/../pipe/common.sh"
cat > dense.yaml <<'END'
conceg: 1
title: Cells and axons for a run that is killed
seed: 5
domain: {size_um: [14, 14, 14], periodic: [true, true, true], pia: [0, 0, 1]}
dictionary: default
density_per_um3: 4e-4
types:
  - {name: astrocyte, class: astrocyte, entry: astrocyte, fraction: 1, radius_scale: 1.6}
  - {name: passing axon, class: axon, cable_density_per_um2: 0.5, radius_um: {mean: 0.42, sd: 0.11, minimum: 0.28}}
stages: [place, triangulate, grow, relax, mesh, simulate]
grow: {max_edge_um: 3}
mesh: {h_um: 0.15, volumes: false}
simulate: {walkers: 6000, step_ms: 0.01, margin_um: 0}
END
saved="$scratch/it's saved" # a folder whose name YAML must not read
export saved
conceg run dense.yaml -q -o whole.cgx || exit 1
conceg run dense.yaml -q --checkpoint straight -o straight.cgx || exit 1
check "checkpoints leave no trace in the document" cmp straight.cgx whole.cgx
check "no unfinished work stays" sh -c '! ls straight | grep -q part'

# killed_when FILE BYTES [options]: kills a run once that file of the folder has so many bytes; fails when the run ended before.
killed_when() {
  part=$1 bytes=$2
  shift 2
  conceg run dense.yaml -q --checkpoint "$saved" -o killed.cgx "$@" &
  child=$!
  while kill -0 "$child" 2>/dev/null; do
    size=$(stat -c %s "$saved/$part" 2>/dev/null || echo 0)
    if [ "$size" -gt "$bytes" ]; then
      kill -KILL "$child" 2>/dev/null || break
      wait "$child" 2>/dev/null || true
      return 0
    fi
    sleep 0.01
  done
  wait "$child" 2>/dev/null || true
  return 1
}
check "killed in mesh with surfaces finished" killed_when 05-mesh.part 200000
check "no document yet" test ! -e killed.cgx
cp -r "$saved" again
check "the run goes on" sh -c 'conceg run dense.yaml -v --until mesh --checkpoint "$saved" --resume -o mesh.cgx 2> resumed.log'
check "with what mesh had finished" grep -qE 'mesh: [1-9][0-9]* cells taken over from .*05-mesh.part' resumed.log
grep -o '[0-9]* cells taken over' resumed.log || true
conceg strip protocol,walkers,signals,provenance whole.cgx -q -o whole-bare.cgx
conceg strip provenance mesh.cgx -q -o mesh-bare.cgx
check "the same meshes" cmp mesh-bare.cgx whole-bare.cgx
check "05-mesh.part is gone" test ! -e "$saved/05-mesh.part"

check "killed in simulate with walkers finished" killed_when 06-simulate.part 1000 --resume
check "the run goes on once more" sh -c 'conceg run dense.yaml -v --checkpoint "$saved" --resume -o resumed.cgx 2> resumed.log'
check "with the walkers it had" grep -qE 'going on with [1-9][0-9]* of [0-9]+ blocks of walkers done' resumed.log
check "the bytes of a run that nobody killed" cmp resumed.cgx whole.cgx

# Without --resume all is made again, and what stands there is not asked.
mv again other
check "a run from the beginning" conceg run dense.yaml -q --set mesh.h_um=0.2 --until mesh --checkpoint other -o fresh.cgx
# A file that the recipe names is kept as it is.
check "a file of one's own" conceg run dense.yaml -q --set mesh.h_um=0.3 --set mesh.checkpoint=own.part --until mesh --checkpoint third -o own.cgx
done_checking
