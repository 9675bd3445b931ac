#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Second growth: bars that found no room go on in the space that relaxation moved; pipe, one process, any threads: same bytes.
. "$(dirname -- "$0")/common.sh"

# Crowded by passing axons, which give up at once.
sed 's/^mesh:.*/  - {name: passing axon, class: axon, cable_density_per_um2: 0.6, radius_um: {mean: 0.42, sd: 0.11, minimum: 0.28}}/; s/28, 28, 28/20, 20, 20/' \
  "$root/tests/pipe/small.yaml" >once.yaml
printf 'relax: {iterations: 10}\nstages: [place, triangulate, grow, relax, analyse]\n' >>once.yaml
sed 's/grow, relax, analyse/grow, relax, grow, relax, analyse/' once.yaml >twice.yaml
printf 'grow: {finish: true, retries: 1}\nkeep: [network]\n' >>twice.yaml
printf 'grow: {retries: 1}\n' >>once.yaml

for threads in 1 3; do
  conceg run twice.yaml --threads $threads -v -o twice$threads.cgx 2>log || { cat log >&2; exit 1; }
done
check "1 and 3 threads give the same bytes" cmp twice1.cgx twice3.cgx
conceg place -p twice.yaml -q | conceg triangulate -q | conceg grow -q | conceg relax -q | conceg grow -q | conceg relax -q |
  conceg analyse -q >pipe.cgx
check "the pipe gives the bytes of the run" cmp pipe.cgx twice1.cgx
check "the result is valid" conceg validate -q twice1.cgx
conceg run twice.yaml --until relax -q -o relaxed.cgx
check "--until relax ends after the second one" test "$(conceg info relaxed.cgx | grep -c '  relax (')" = 2

# Cable grown, um, as its own skeleton has it.
conceg run once.yaml -v -o once.cgx 2>log
first=$(sed -n 's/.*cable \([0-9.]*\) mm.*/\1/p' log)
grown=$(conceg run twice.yaml --until grow -v -o /dev/null 2>&1 | sed -n 's/.*cable \([0-9.]*\) mm.*/\1/p' | tail -1)
printf 'cable: %s mm once, %s mm with second growth\n' "$first" "$grown"
check "second growth adds cable" awk "BEGIN { exit !($grown > $first) }"
check_not "without the network there is no second growth" sh -c "grep -v keep: twice.yaml >lost.yaml; conceg run lost.yaml -q -o lost.cgx 2>err"
check "and the error says so" grep -q "needs /network" err
done_checking
