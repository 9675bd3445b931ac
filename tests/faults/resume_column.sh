#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A small column with open ends, layers, glia and axons, killed once in each stage and twice inside of mesh, resumed each time: the bytes of a
# run that nobody killed.  resume_column.sh BIN SOURCE
. "$(dirname -- "$0")/../pipe/common.sh"
cat > column.yaml <<'END'
conceg: 1
title: A small column for a run that is killed
seed: 3
domain: {size_um: [13, 13, 36], periodic: [true, true, false], pia: [0, 0, 1]}
dictionary: default
layers:
  - {name: low, z_um: [0, 18], density_per_um3: 3e-4}
  - {name: high, z_um: [18, 36], density_per_um3: 3e-4}
types:
  - {name: low astrocyte, class: astrocyte, entry: astrocyte, layer: low, fraction: 1, radius_scale: 1.6}
  - {name: high astrocyte, class: astrocyte, entry: astrocyte, layer: high, fraction: 1, radius_scale: 1.6}
  - {name: microglia, class: microglia, entry: microglia, density_per_um3: 1.6e-4}
  - {name: passing axon, class: axon, cable_density_per_um2: 0.3, radius_um: {mean: 0.42, sd: 0.11, minimum: 0.28}}
stages: [place, triangulate, grow, relax, mesh, analyse]
mesh: {h_um: 0.25}
analyse: {points: 20000}
END
conceg run column.yaml -q -o column.cgx || exit 1
kills=0
for part in 01-place.cgx 02-triangulate.cgx 03-grow.cgx 04-relax.cgx 05-mesh.part 05-mesh.part 05-mesh.cgx; do
  bytes=1000
  [ $part != 05-mesh.part ] || bytes=$((100000 + kills * 100000))
  conceg run column.yaml -q --checkpoint column --resume -o resumed-column.cgx &
  child=$!
  while kill -0 "$child" 2>/dev/null; do
    size=$(stat -c %s "column/$part" 2>/dev/null || echo 0)
    if [ "$size" -gt $bytes ]; then
      kill -KILL "$child" 2>/dev/null && kills=$((kills + 1))
      break
    fi
    sleep 0.005
  done
  wait "$child" 2>/dev/null || true
done
echo "small column: killed $kills times"
check "killed in at least five places" test $kills -ge 5
rm -f resumed-column.cgx
check "the column goes on" conceg run column.yaml -q --checkpoint column --resume -o resumed-column.cgx
check "the column has the bytes of a run that nobody killed" cmp resumed-column.cgx column.cgx
done_checking
