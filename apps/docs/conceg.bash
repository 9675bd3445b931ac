# SPDX-License-Identifier: BSD-3-Clause
# bash completion for conceg: what it offers is what the programs say of themselves (conceg WORD --help=list, conceg help topics).
_conceg() {
  local program=${COMP_WORDS[0]} current=${COMP_WORDS[COMP_CWORD]} line=${COMP_LINE:0:COMP_POINT} list= stage= key= before=() word tab=$'\t'
  COMPREPLY=()
  # Bash cuts words at "="; the line has them whole.
  read -r -a before <<<"$line"
  [[ $line == *[[:space:]] ]] && before+=("")
  local last=$((${#before[@]} - 1))
  local whole=${before[last]} previous=${before[last - 1]}
  local words=()
  for word in "${before[@]:1:last-1}"; do [[ $word == [a-z]* && ${#words[@]} -lt 2 ]] && words+=("$word") || break; done
  if [[ ${words[0]} == help ]]; then
    list=$({ "$program" --help=list | cut -f 2 | grep -v '^-'; "$program" help topics | awk '{ print $1 }'; } 2>/dev/null)
    COMPREPLY=($(compgen -W "$list" -- "$current"))
    return
  fi
  # --set stage.key=value, and --set=stage.key=value
  if [[ $previous == --set || $whole == --set=* ]]; then
    whole=${whole#--set=}
    stage=${whole%%.*}
    if [[ $whole != *.* ]]; then
      COMPREPLY=($(compgen -S . -W "$("$program" stages 2>/dev/null | awk '{ print $1 }')" -- "$whole"))
    elif [[ $whole != *=* ]]; then
      list=$("$program" "$stage" --help=list 2>/dev/null | awk -F '\t' -v s="$stage" '$1 == "param" { print s "." substr($2, 3) "=" }')
      COMPREPLY=($(compgen -W "$list" -- "$whole"))
    else
      key=${whole#*.}
      list=$("$program" "$stage" --help=list 2>/dev/null | awk -F '\t' -v k="--${key%%=*}" '$1 == "param" && $2 == k { print $4 }')
      [[ $list == *'|'* ]] && COMPREPLY=($(compgen -W "${list//|/ }" -- "${whole#*=}"))
    fi
    compopt -o nospace 2>/dev/null
    return
  fi
  list=$("$program" "${words[@]}" --help=list 2>/dev/null)
  # The value of an option: one of its choices, else a file.
  local option=$previous value=$current choices=
  [[ $whole == --*=* ]] && option=${whole%%=*} value=${whole#*=}
  choices=$(awk -F '\t' -v o="$option" '($2 == o || "-" $3 == o) && $4 != "-" { print $4; exit }' <<<"$list")
  if [[ -n $choices && $option == -* ]]; then
    [[ $choices == *'|'* ]] && COMPREPLY=($(compgen -W "${choices//|/ }" -- "$value")) || COMPREPLY=($(compgen -f -- "$value"))
    return
  fi
  if [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$(awk -F '\t' '$2 ~ /^--/ { print $2 }' <<<"$list")" -- "$current"))
    return
  fi
  choices=$(awk -F '\t' '$1 == "word" { print $2 }' <<<"$list")
  if [[ -n $choices ]]; then COMPREPLY=($(compgen -W "$choices" -- "$current"))
  elif [[ ${words[0]} == params ]]; then COMPREPLY=($(compgen -W "$("$program" stages 2>/dev/null | awk '{ print $1 }')" -- "$current"))
  else mapfile -t COMPREPLY < <(compgen -d -- "$current"; compgen -f -- "$current" | grep -E '\.(cgx|yaml|yml|swc)$'); fi
}
complete -F _conceg conceg
