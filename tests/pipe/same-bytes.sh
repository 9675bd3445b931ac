#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Same seed, same bytes: pipe or one process, 1, 2 or 3 threads, an old processor or a new one. Another seed: another tissue.
. "$(dirname -- "$0")/common.sh"
recipe=$root/$3

check "the pipe runs" pipeline pipe.cgx "$recipe"
for threads in 1 2 3; do
  conceg run "$recipe" --until mesh --threads $threads -v -o run$threads.cgx 2>log$threads || { cat log$threads >&2; exit 1; }
  check "run with $threads threads gives the bytes of the pipe" cmp pipe.cgx run$threads.cgx
done
# The math library picks other code on a processor without AVX2 and FMA; the bytes must not change.
GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F conceg run "$recipe" --until mesh -q -o old.cgx
check "a processor without FMA gives the same bytes" cmp pipe.cgx old.cgx

conceg run "$recipe" --until grow --seed 8 -q -o other.cgx
conceg run "$recipe" --until grow -q -o same.cgx
check_not "another seed gives another tissue" cmp -s same.cgx other.cgx
check "the result is valid" conceg validate -q pipe.cgx

# The program's own counters show that the work was shared: with 2 threads each worker does more than 20 % of the steps.
for counter in grow.steps relax.items mesh.faces; do
  share=$(sed -n "s/.*counter $counter: worker 0: \([0-9]*\), worker 1: \([0-9]*\).*/\1 \2/p" log2 |
    awk '{ a += $1; b += $2 } END { if (a + b > 0) printf "%d", 100 * (a < b ? a : b) / (a + b) }')
  printf '%s: the lazier of 2 workers did %s %% of the steps\n' "$counter" "${share:-none}"
  check "$counter is shared by 2 workers" test "${share:-0}" -gt 20
done
done_checking
