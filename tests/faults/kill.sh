#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# SIGKILL and SIGINT at random moments of every stage, of a pipe and of a run with checkpoints: no torn output, the input untouched,
# nothing in TMPDIR, at most one unfinished file beside the output, taken away by the next run.  kill.sh BIN SOURCE KILLER KILLS
killer=$3 kills=$4
. "$(dirname -- "$0")/../pipe/common.sh"
seed=${CONCEG_KILL_SEED:-1}
printf 'seed %s (CONCEG_KILL_SEED repeats another run)\n' "$seed"
recipe=$root/tests/pipe/small.yaml
mkdir cp tmp
TMPDIR=$scratch/tmp
export TMPDIR
conceg run "$recipe" --until mesh -q --checkpoint cp -o mesh.cgx || exit 1
conceg export cp/03-grow.cgx --to swc --dir cells -q || exit 1
{ echo b,signal; for b in 0 1 2 3 4 6 8; do awk -v b=$b 'BEGIN { print b "," exp(-b / 4) }'; done; } > signals.csv
conceg import signal signals.csv --pulse-duration-ms 5 --pulse-separation-ms 20 --compartment intra -q -o signals.cgx || exit 1
sha256sum cp/* mesh.cgx cells/swc/* > before
stat -c '%n %Y %Z %s' cp/* mesh.cgx >> before

stages=$(for program in "$(dirname -- "$(command -v conceg)")"/conceg-*; do basename -- "$program" | sed 's/^conceg-//'; done)
per_stage=$((kills / $(echo "$stages" | wc -l)))
[ "$per_stage" -ge 2 ] || per_stage=2
hit=0 all=0
for stage in $stages; do
  all=$((all + 1))
  output=$stage/out.cgx
  mkdir "$stage"
  case $stage in
    place) set -- conceg place -p "$root/apps/recipes/column.yaml" ;;
    triangulate) set -- conceg triangulate cp/01-place.cgx ;;
    grow) set -- conceg grow cp/02-triangulate.cgx ;;
    relax) set -- conceg relax cp/03-grow.cgx ;;
    block) set -- conceg block cp/04-relax.cgx --lo-um 5 --hi-um 20 ;;
    mesh) set -- conceg mesh cp/04-relax.cgx --set mesh.h_um=0.5 ;;
    simulate) set -- conceg simulate mesh.cgx --walkers 2000 --step-ms 0.01 ;;
    analyse) set -- conceg analyse mesh.cgx ;;
    fit) set -- conceg fit signals.cgx --kernel exact ;;
    characterise) set -- conceg characterise --class pyramidal cells/swc/*.swc ;;
    import) set -- conceg import swc cells/swc ;;
    export | render)
      output=$stage/files
      set -- conceg $stage mesh.cgx --dir "$output" ;;
    report)
      output=$stage/page.html
      set -- conceg report mesh.cgx --page "$output" ;;
    *)
      check "the test knows how to run the stage $stage" false
      continue ;;
  esac
  case $output in *.cgx) set -- "$@" -o "$output" ;; esac
  if "$killer" "$seed" "$per_stage" run "$stage" "$stage" "$output" "$@" --progress=json > log; then hit=$((hit + 1)); check "$stage" true; else check "$stage survives" false; fi
  cat log
done
check "every stage was hit inside run(): $hit of $all" test "$hit" -eq "$all"

# While the output is written: here an unfinished file can be left.
mkdir strip
check "a kill while writing" "$killer" "$seed" 4 write strip strip strip/out.cgx conceg strip volumes mesh.cgx --progress=json -o strip/out.cgx

sha256sum cp/* mesh.cgx cells/swc/* > after
stat -c '%n %Y %Z %s' cp/* mesh.cgx >> after
check "no input was touched" cmp before after

# A whole pipe, and a run with checkpoints that goes on where it was.
conceg run "$recipe" --until relax -q -o whole.cgx
# The shell is waited for, its stages are not: one that is still in fsync keeps its file locked, so that no sweep may take it.
gone() { for _ in $(seq 400); do kill -0 -- "-$1" 2>/dev/null || return 0; sleep 0.05; done; echo "group $1 lives on after SIGKILL"; }
random() { awk -v s="$seed" -v k="$1" 'BEGIN { srand(1000 * s + k); printf "%.3f", 0.05 + 1.2 * rand() }'; }
turns=3
[ "$kills" -lt 200 ] || turns=20
for k in $(seq "$turns"); do
  setsid sh -c "conceg place -q -p '$recipe' | conceg triangulate -q | conceg grow -q | conceg relax -q -o piped.cgx" 2>/dev/null &
  group=$!
  sleep "$(random "$k")"
  kill -KILL -- "-$group" 2>/dev/null || true
  wait "$group" 2>/dev/null || true
  gone "$group"
  if [ -e piped.cgx ]; then check "the pipe was done before" cmp piped.cgx whole.cgx; else check "a killed pipe has no output" true; fi
  check "nothing in TMPDIR after it" sh -c 'test -z "$(ls -A tmp)"'
  rm -f piped.cgx

  rm -rf saved resumed.cgx
  conceg run "$recipe" --until relax -q --checkpoint saved -o resumed.cgx &
  child=$!
  sleep "$(random "$((1000 + k))")"
  kill -KILL "$child" 2>/dev/null || true
  wait "$child" 2>/dev/null || true
  printf 'run --checkpoint, killed with %s checkpoints done\n' "$(ls saved 2>/dev/null | wc -l)"
  conceg run "$recipe" --until relax -q --checkpoint saved --resume -o resumed.cgx
  check "resumed bytes are the uninterrupted ones" cmp resumed.cgx whole.cgx
  find . -name ".conceg-*" > left
  [ ! -s left ] || ls -l $(cat left) saved
  check "no unfinished file is left" test ! -s left
done
done_checking
