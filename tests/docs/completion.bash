#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# What bash offers after TAB.  completion.bash BIN SCRIPTS
PATH=$1:$PATH
. "$2/conceg.bash" || exit 1
failed=0
# offers "line" expected...: every expected word is offered; !word is not. Words are cut at "=" as bash does.
offers() {
  local line=$1 want
  shift
  COMP_LINE=$line COMP_POINT=${#line}
  read -r -a COMP_WORDS <<< "${line//=/ = }"
  [[ $line == *[[:space:]=] ]] && COMP_WORDS+=("")
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _conceg
  for want in "$@"; do
    case " ${COMPREPLY[*]} " in
      *" ${want#!} "*) [[ $want != !* ]] || { echo "FAILED: $line<TAB> offers ${want#!}"; failed=1; } ;;
      *) [[ $want == !* ]] || { echo "FAILED: $line<TAB> does not offer $want: ${COMPREPLY[*]}"; failed=1; } ;;
    esac
  done
}
[[ -x $1/conceg-grow ]] || { echo "SKIPPED: completion is tried on the grow stage, which is not in this build"; exit 77; }
cd "$(mktemp -d)" || exit 1
touch a.cgx b.txt
offers "conceg gr" grow '!info'
offers "conceg in" info '!grow'
offers "conceg swc " check repair
offers "conceg help ex" exit-codes
offers "conceg grow --occ" --occupancy
offers "conceg grow --occupancy " capsule nodes
offers "conceg grow --hazard=" per_um per_step
offers "conceg info --progress " auto json none
offers "conceg run r.yaml --set gr" grow.
offers "conceg run r.yaml --set grow.occ" grow.occupancy=
offers "conceg run r.yaml --set grow.occupancy=" capsule nodes
offers "conceg info " a.cgx '!b.txt'
offers "conceg params gr" grow
rm -f a.cgx b.txt && rmdir "$PWD"
[[ $failed == 0 ]] && echo "all offered"
exit $failed
