#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What zsh offers after TAB, on a terminal of its own (zpty).  completion_zsh.sh BIN SCRIPTS
command -v zsh > /dev/null || { echo "SKIPPED: no zsh"; exit 77; }
[ -x "$1/conceg-grow" ] || { echo "SKIPPED: completion is tried on the grow stage, which is not in this build"; exit 77; }
zsh -n "$2/_conceg" || exit 1
PATH=$1:$PATH SCRIPTS=$2 exec zsh -f -c '
zmodload zsh/zpty || { echo "SKIPPED: this zsh has no zpty"; exit 77 }
failed=0
offers() { # line expected
  zpty shell "zsh -f -i"
  zpty -w shell "PS1=; fpath=($SCRIPTS \$fpath); autoload -Uz compinit; compinit -u -D; LISTMAX=1000; stty -echo columns 200; bindkey \"^I\" complete-word; print REA\DY"
  zpty -r -m shell out "*READY*"
  zpty -w -n shell "$1"$'"'\\t\\t'"'
  out="" part=""
  for i in {1..40}; do
    while zpty -r -t shell part 2>/dev/null; do out+=$part; done
    [[ $out == *$2* ]] && break
    sleep 0.1
  done
  [[ $out == *$2* ]] || { print "FAILED: $1<TAB> does not offer $2: $out"; failed=1 }
  zpty -d shell
}
offers "conceg val" validate
offers "conceg swc rep" repair
offers "conceg grow --occu" --occupancy
offers "conceg grow --occupancy c" capsule
offers "conceg run r.yaml --set grow.occ" grow.occupancy=
exit $failed'
