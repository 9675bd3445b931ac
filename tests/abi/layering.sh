#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Who may include whom: public headers -> libc; libconceg/src -> public headers, HDF5, libyaml; stages/x -> public headers,
# stages/common, its own libraries, never another stage and never libconceg/src; apps -> public headers only.
# HDF5 is called in h5*.c only, by stages in h5_*.cpp only (files of other programs that are HDF5), libyaml in yaml*.c only.  layering.sh SOURCE
cd "$1" || exit 1
failed=0

# forbid "why" "pattern" files...: no line of these files may match.
forbid() {
  why=$1 pattern=$2
  shift 2
  [ $# -gt 0 ] || { echo "$why: no files to look at"; failed=1; return; }
  if hits=$(grep -nE "$pattern" "$@"); then
    echo "$why:"
    echo "$hits"
    failed=1
  fi
}

# A rule that finds nothing in a planted offence is no rule.
planted=$(mktemp) || exit 1
echo '  hid_t file = H5Fopen(name, 0, 0);' > "$planted"
(forbid "planted" '\<H5[A-Z][a-z]*\(|\<hid_t\>' "$planted"; [ "$failed" -eq 1 ]) > /dev/null || { echo "the rule on HDF5 finds nothing"; failed=1; }
rm -f "$planted"

libc='(assert|complex|ctype|errno|fenv|float|inttypes|limits|locale|math|setjmp|signal|stdarg|stdatomic|stdbool|stddef|stdint|stdio|stdlib|string|time)\.h'
if hits=$(grep -rnE '^[[:space:]]*#[[:space:]]*include' libconceg/include --include='*.h' | grep -vE "include[[:space:]]+(\"conceg/[a-z0-9_]+\.h\"|<$libc>)"); then
  echo "public headers include more than libc and each other:"
  echo "$hits"
  failed=1
fi

sources=$(find libconceg/src -name '*.[ch]')
forbid "HDF5 outside of libconceg/src/h5*" '\<H5[A-Z][A-Za-z]*_?[a-z_0-9]*[[:space:]]*\(|\<hid_t\>|include[[:space:]]*[<"](hdf5|H5)' \
  $(echo "$sources" | grep -v '/h5[a-z_]*\.[ch]$')
forbid "libyaml outside of libconceg/src/yaml*.c" 'include[[:space:]]*<yaml\.h>|\<yaml_(parser|event|emitter|document|token|node)_' \
  $(echo "$sources" | grep -v '/yaml[a-z_]*\.c$')
forbid "the library includes stages, apps or C++" 'include[[:space:]]*[<"].*(stages/|apps/|\.hpp)' $sources
forbid "the library ends the program, or writes to standard output" '\<(exit|abort|_exit|printf|puts|putchar|setlocale)\(|\<stdout\>' $(echo "$sources" | grep -v '/save[a-z_]*\.c$')

apps=$(find apps -name '*.[ch]')
forbid "apps include the library's inside, or other libraries" 'include[[:space:]]*[<"](.*libconceg/|.*_internal\.h|hdf5|yaml\.h|schema\.h|recipe\.h)|\<H5[A-Z][a-z]+\(|\<yaml_' $apps

for folder in stages/*/; do
  stage=$(basename "$folder")
  files=$(find "$folder" \( -name '*.cpp' -o -name '*.hpp' -o -name '*.c' -o -name '*.h' \))
  [ -n "$files" ] || continue
  forbid "stages/$stage includes libconceg/src or climbs out of its folder" 'include[[:space:]]*"(\.\./\.\./([^c]|c[^o])|.*libconceg/src|.*_internal\.h)' $files
  for other in stages/*/; do
    other=$(basename "$other")
    [ "$other" = "$stage" ] || [ "$other" = common ] || forbid "stages/$stage includes stages/$other" "include[[:space:]]*[<\"].*\\<$other/" $files
  done
  # Formats of other programs that are HDF5 have a file of their own, h5_*.cpp.
  forbid "stages/$stage calls HDF5 or libyaml" '\<H5[A-Z][a-z]+\(|\<yaml_' $(echo "$files" | tr ' ' '\n' | grep -v '/h5_[a-z0-9_]*\.cpp$')
done

spdx=$(find libconceg apps stages tests \( -name '*.[ch]' -o -name '*.[ch]pp' -o -name '*.sh' -o -name CMakeLists.txt -o -name '*.cmake' \) -exec grep -L SPDX-License-Identifier {} +)
[ -z "$spdx" ] || { echo "files without an SPDX line:"; echo "$spdx"; failed=1; }
[ "$failed" -eq 0 ] && echo "all layers hold"
exit "$failed"
