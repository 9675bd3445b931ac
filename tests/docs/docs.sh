#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Pages of this build: man pages, the C reference, topics, the install.  docs.sh BUILD SOURCE
build=$1 source=$2
bin=$build/bin docs=$build/docs
PATH=$bin:$PATH
export PATH
t=$(mktemp -d) || exit 1
trap 'rm -rf "$t"' EXIT
failed=0 checked=0
fail() { echo "FAILED: $*"; failed=$((failed + 1)); }
good() { checked=$((checked + 1)); }

# Options of a page as the parser has them, against those in the man page.
compare() { # list page
  awk -F '\t' '$1 == "option" || $1 == "param" { print $2 }' "$1" | sort -u > "$t/parser"
  grep -A 1 '^\.TP' "$2" | sed -n 's/^\\fB//p' | sed 's/\\fR.*//; s/\\-/-/g; s/^-., //' | grep '^--' | sort -u > "$t/page"
  cmp -s "$t/parser" "$t/page"
}

pages() { # words...
  name=conceg$(for word in "$@"; do printf -- '-%s' "$word"; done)
  page=$docs/man1/$name.1
  [ -s "$page" ] || { fail "no page $name.1"; return; }
  conceg "$@" --help=list > "$t/list" || fail "$name --help=list"
  grep -q '^option' "$t/list" || fail "$name lists no option"
  compare "$t/list" "$page" || { fail "$name: options of the parser and of the page differ"; diff "$t/parser" "$t/page"; }
  conceg "$@" --help > "$t/plain" || fail "$name --help"
  # The example's program is conceg, or conceg after a setting; its word is a real one.
  example=$(sed -n '/^example:/,$p' "$t/plain" | sed -n '2s/^ *//p')
  example_word=$(printf '%s\n' "$example" | sed -n 's/^\([A-Z_]*=[^ ]* \)*conceg \([a-z]*\).*/\2/p')
  awk -F '\t' '{ print $2 }' "$t/words" | grep -qx -- "$example_word" || fail "$name: no example of a real word: $example"
  # Every parameter in the page with default, unit and range, as the table of conceg params has them.
  if conceg params "$1" > "$t/params" 2>/dev/null; then
    sed -n 's/^  --[a-z0-9_]* .*\(\[.*\]\)$/\1/p' "$t/params" > "$t/bounds"
    rows=$(grep -c '^  --' "$t/params")
    [ "$rows" = "$(wc -l < "$t/bounds")" ] || fail "$name: a parameter without default and range"
    sed 's/\\-/-/g; s/\\e/\\/g' "$page" > "$t/text"
    while IFS= read -r bounds; do grep -qF -- "$bounds" "$t/text" || fail "$name: $bounds is not in the page"; good; done < "$t/bounds"
  fi
  good
}

conceg --help=list | grep '^word' > "$t/words"
pages
for word in $(cut -f 2 "$t/words"); do
  case $word in help|version) continue ;; esac
  pages "$word"
  for inner in $(conceg "$word" --help=list | awk -F '\t' '$1 == "word" { print $2 }'); do pages "$word" "$inner"; done
done
[ "$checked" -gt 20 ] || fail "only $checked pages and parameters were looked at"

# The comparison sees an option that the page lacks, and one that the parser lacks.
conceg info --help=list > "$t/list"
printf 'option\t--planted\t-\t-\tx\n' >> "$t/list"
compare "$t/list" "$docs/man1/conceg-info.1" && fail "a planted option of the parser was not seen"
conceg info --help=list > "$t/list"
{ cat "$docs/man1/conceg-info.1"; printf '.TP\n\\fB\\-\\-planted\\fR\nx\n'; } > "$t/planted.1"
compare "$t/list" "$t/planted.1" && fail "a planted option of the page was not seen"

# Every function has a docstring, and every one its page; a planted one without is named.
awk -v check=1 -f "$source/libconceg/docs/reference.awk" "$source"/libconceg/include/conceg/*.h || fail "functions without a docstring"
printf '/* Title. */\n\nCONCEG_API int conceg_planted(void);\n' > "$t/planted.h"
awk -v check=1 -f "$source/libconceg/docs/reference.awk" "$t/planted.h" > "$t/out" && fail "a planted function without a docstring was not seen"
grep -q 'conceg_planted has no docstring' "$t/out" || fail "the planted function is not named"
functions=$(awk -F '\t' '$1 == "function" { print $2 }' "$source/spec/symbols.tsv")
[ -n "$functions" ] || fail "spec/symbols.tsv names no function"
for function in $functions; do
  [ -s "$docs/man3/$function.3" ] || fail "no page $function.3"
  grep -q "id=\"$function\"" "$docs/api.html" || fail "$function is not in api.html"
done

# Topics: all print something; groups of the format; the nearest one for a wrong name.
for topic in $(conceg help topics | awk '{ print $1 }'); do
  [ "$(conceg help "$topic" | wc -c)" -gt 100 ] || fail "topic $topic is empty"
done
conceg help format /cells | grep -q 'name: soma,.*unit: um' || fail "help format /cells has no soma"
conceg help recipess 2> "$t/err" && fail "help recipess passed"
grep -q 'nearest topic is recipes' "$t/err" || fail "no suggestion for recipess"

# Installed: man finds them.
if DESTDIR=$t/install cmake --install "$build" --prefix /p > "$t/log" 2>&1; then
  share=$t/install/p/share
  for file in bash-completion/completions/conceg zsh/site-functions/_conceg man/man1/conceg.1 man/man3/conceg_doc_open.3; do
    [ -s "$share/$file" ] || fail "$file is not installed"
  done
  if command -v man > /dev/null; then
    man -M "$share/man" conceg_doc_open 2>/dev/null | grep -q conceg_doc_open || fail "man conceg_doc_open"
    man -M "$share/man" conceg-grow 2>/dev/null | grep -q 'lambda' || [ ! -x "$bin/conceg-grow" ] || fail "man conceg-grow"
  fi
else fail "cmake --install: $(tail -1 "$t/log")"; fi

# Lint: no warning but that there is no date (pages must not depend on the day), and a planted one is seen.
lint() { mandoc -T lint -W warning "$1" 2>&1 | grep -v 'missing date'; }
if command -v mandoc > /dev/null; then
  for page in "$docs"/man1/*.1 "$docs"/man3/conceg_*.h.3; do lint "$page" > "$t/out" && { fail "lint of $page"; cat "$t/out"; }; done
  printf '.TH X 1 "" x\n.SH NAME\n.frobnicate\n.TP\n' > "$t/bad.1"
  lint "$t/bad.1" > /dev/null || fail "lint saw nothing in a planted page"
elif [ "$failed" = 0 ]; then
  echo "SKIPPED: the lint of man pages, for want of mandoc (all else passed)"
  exit 77
fi
echo "$checked pages and parameters, $(echo "$functions" | wc -l) functions, $failed failed"
[ "$failed" = 0 ]
