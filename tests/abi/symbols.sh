#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The binary interface: the libraries show exactly the functions of their headers; functions, sizes of structures and values of
# constants are those of spec/symbols.tsv, which is their history.  symbols.sh SOURCE BUILD CC [--update]
# With --update the history takes in what is new; what it says of older symbols stays.
source=$1 build=$2 cc=$3 update=${4:-}
include=$source/libconceg/include
history=$source/spec/symbols.tsv
t=$(mktemp -d) || exit 1
trap 'rm -rf "$t"' EXIT
failed=0
complain() { echo "$1"; failed=1; }

# A header without comments and preprocessor lines, one declaration a line.
declarations() {
  sed -e 's://.*$::' "$1" | awk '{
    line = $0
    while (1) {
      if (inside) { i = index(line, "*/"); if (!i) { line = ""; break } line = substr(line, i + 2); inside = 0 }
      i = index(line, "/*"); if (!i) break
      j = index(substr(line, i), "*/")
      if (j) line = substr(line, 1, i - 1) " " substr(line, i + j + 1); else { line = substr(line, 1, i - 1); inside = 1 }
    }
    if (line !~ /^[ \t]*#/ && !continued) printf "%s ", line
    continued = line ~ /\\$/ && (continued || line ~ /^[ \t]*#/)
  }' | tr ';' '\n'
}

# Functions of a header: CONCEG_API ... name(
functions() { declarations "$1" | grep 'CONCEG_API' | sed -n 's/^[^(]*[ *]\(conceg_[a-z0-9_]*\)(.*/\1/p'; }

for header in "$include"/conceg/*.h; do
  library=conceg
  [ "$(basename "$header")" = query.h ] && library=conceg_query
  functions "$header" | sed "s/^/$library	/"
done | sort -u > "$t/headers"
count=$(wc -l < "$t/headers")
[ "$count" -ge 60 ] || complain "only $count functions found in the headers"
for library in conceg conceg_query; do
  file=$build/lib/lib$library.so
  [ -e "$file" ] || { echo "$library was not built: not compared"; grep -v "^$library	" "$t/headers" > "$t/rest"; mv "$t/rest" "$t/headers"; continue; }
  nm -D --defined-only "$file" | awk '$2 != "A" { print $3 }' | sed 's/@.*//' > "$t/shown"
  grep -v '^conceg_' "$t/shown" && complain "lib$library.so shows symbols that do not begin with conceg_"
  sed "s/^/$library	/" "$t/shown"
done | sort -u > "$t/symbols"
if ! diff "$t/headers" "$t/symbols" > "$t/diff"; then
  sed -n 's/^</in the headers, but not exported:/p; s/^>/exported, but in no header:/p' "$t/diff"
  failed=1
fi

# Sizes and constants, by a program of the headers themselves. (printf keeps backslashes, echo need not.)
put() { printf '%s\n' "$1"; }
{
  put '#include <conceg/conceg.h>'
  put '#include <conceg/query.h>'
  put '#include <stdio.h>'
  put '#define ROW(name, value, text) printf("constant\tCONCEG_" #name "\t%d\n", value);'
  put 'int main(void) { CONCEG_STATUS_MAP(ROW)'
  for header in "$include"/conceg/*.h; do
    declarations "$header" | sed -n 's/^ *} \(conceg_[a-z0-9_]*\) *$/\1/p' | sort -u | while read -r name; do
      declarations "$header" | grep -q "typedef enum $name {" || put "printf(\"struct\\t$name\\t%zu\\n\", sizeof($name));"
    done
    {
      declarations "$header" | tr '\n' ';' | grep -o 'typedef enum conceg_[a-z_]* {[^}]*}' | grep -o 'CONCEG_[A-Z0-9_]* *=' | tr -d ' ='
      sed -n 's/^#define \(CONCEG_[A-Z0-9_]*\) (*-*[0-9][0-9a-fu]*)* *\(\/\*.*\)*$/\1/p' "$header" | grep -v 'CONCEG_VERSION_'
    } | while read -r name; do put "printf(\"constant\\t$name\\t%lld\\n\", (long long)$name);"; done
  done
  put 'return 0; }'
} > "$t/layout.c"
"$cc" -std=c11 -I"$include" "$t/layout.c" -o "$t/layout" -lm 2> "$t/log" || { head -20 "$t/log"; exit 1; }
"$t/layout" | sort -u > "$t/values"
[ "$(grep -c '^struct' "$t/values")" -ge 8 ] && [ "$(grep -c '^constant' "$t/values")" -ge 40 ] || complain "too few structures or constants found"
{ sed 's/^\([^	]*\)	\(.*\)$/function	\2	\1/' "$t/headers"; cat "$t/values"; } | sort > "$t/now"

version=$(sed -n 's/^#define CONCEG_VERSION_TEXT "\([0-9]*\.[0-9]*\).*/\1/p' "$include/conceg/base.h")
if [ "$update" = --update ]; then
  {
    printf '# What programs that link libconceg rely on, and since when; checked and updated by tests/abi/symbols.sh.\n'
    printf '# A function: its library; a structure: its size in bytes on x86-64; a constant: its value. Rows are never removed.\n'
    printf 'kind\tname\tvalue\tsince\n'
    { [ -e "$history" ] && grep -v '^#\|^kind	' "$history"; sed "s/\$/	$version/" "$t/now"; } | awk -F '\t' '{ key = $1 FS $2; if (!(key in since)) since[key] = $4; value[key] = $3 }
      END { for (key in since) print key "\t" value[key] "\t" since[key] }' | LC_ALL=C sort
  } > "$t/history" && cp "$t/history" "$history"
  echo "$history: $(grep -c '	' "$history") rows"
fi
grep -v '^#\|^kind	' "$history" | cut -f1-3 | sort > "$t/then"
[ -e "$build/lib/libconceg_query.so" ] || { grep -v '	conceg_query$' "$t/then" > "$t/rest"; mv "$t/rest" "$t/then"; }
if ! diff "$t/then" "$t/now" > "$t/diff"; then
  sed -n 's/^</in spec\/symbols.tsv, but not (or otherwise) in the headers:/p; s/^>/in the headers, but not (or otherwise) in spec\/symbols.tsv:/p' "$t/diff"
  echo "What was released may not go or change. New symbols are taken in by: tests/abi/symbols.sh SOURCE BUILD cc --update"
  failed=1
fi
printf '%s functions, %s structures, %s constants: %s\n' "$(grep -c '^function' "$t/now")" "$(grep -c '^struct' "$t/now")" "$(grep -c '^constant' "$t/now")" \
  "$([ "$failed" -eq 0 ] && echo "headers, libraries and history agree" || echo "DIFFERENT")"
exit "$failed"
