#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The examples as an author of a simulator meets them: built against an install that was moved, by find_package and by
# pkg-config, run on a document made here, with their numbers checked; planted defects must show up as leaks.
# examples.sh SOURCE BUILD TISSUE CC [SANITIZERS]
source=$1 build=$2 tissue=$3 cc=$4 sanitize=${5:+-fsanitize=$5}
. "$source/tests/cli/expect.sh"
t=$expect_folder
unset LD_LIBRARY_PATH CONCEG_STAGE_PATH
cmake --install "$build" --prefix "$t/first" > "$t/log" 2>&1 || { cat "$t/log"; exit 1; }
mv "$t/first" "$t/moved"
at=$t/moved
library=$(dirname "$(find "$at" -name libconceg.so)")
if grep -q 'QUERY_WORKS FALSE' "$library/cmake/conceg/conceg-config.cmake"; then
  echo "SKIPPED: no Embree: the examples, which locate points and trace rays, were not run"
  exit 77
fi

# value "label of the line" "word before the number": a number of the last output.
value() { sed -n "/^$1/s/.*$2 \(-\{0,1\}[0-9.e+-]*\).*/\1/p" "$expect_folder/stdout" | head -n 1; }
# holds "what" "awk condition": a claim about numbers; an empty number fails.
holds() { expect_true "$1: $2" awk "BEGIN { exit !($2) }"; }

examples=$at/share/conceg/examples
flags="$sanitize"
cmake -S "$examples" -B "$t/built" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$at" -DCMAKE_C_COMPILER="$cc" \
  -DCMAKE_C_FLAGS="-Wall -Wextra -Wshadow -Werror $flags" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wshadow -Werror $flags" > "$t/log" 2>&1 &&
  cmake --build "$t/built" >> "$t/log" 2>&1 || { cat "$t/log"; exit 1; }

# A component that does not exist, and a version that is not this one, are refused.
sed 's/COMPONENTS query/COMPONENTS query tracts/' "$examples/CMakeLists.txt" > "$t/CMakeLists.txt"
mkdir "$t/wrong" && mv "$t/CMakeLists.txt" "$t/wrong/"
expect_true "an unknown component is refused" sh -c "! cmake -S '$t/wrong' -B '$t/wrong/b' -DCMAKE_PREFIX_PATH='$at' > '$t/log' 2>&1"
expect_true "and named" grep -q 'no component tracts' "$t/log"
sed -i 's/conceg 0.1 REQUIRED.*/conceg 9.0 REQUIRED)/' "$t/wrong/CMakeLists.txt"
expect_true "another version is refused" sh -c "! cmake -S '$t/wrong' -B '$t/wrong/c' -DCMAKE_PREFIX_PATH='$at' > '$t/log' 2>&1"

# The same sources by pkg-config, from the install and from the build folder.
if command -v pkg-config > /dev/null; then
  for folder in "$library/pkgconfig" "$build/pkgconfig"; do
    rm -f "$t/by_pkg_config"
    PKG_CONFIG_PATH=$folder
    export PKG_CONFIG_PATH
    where=$(pkg-config --variable=libdir conceg)
    expect_true "random_walk.c builds with $folder" "$cc" -std=c11 -O2 -Wall -Wextra -Werror $sanitize "$examples/random_walk.c" \
      -o "$t/by_pkg_config" $(pkg-config --cflags --libs conceg-query) -lm -Wl,-rpath,"$where"
    expect 2 "" sh -c "'$t/by_pkg_config' 2> /dev/null; code=\$?; echo 'error: usage' >&2; exit \$code"
  done
else
  echo "SKIPPED: the part with pkg-config, which is not here"
fi

expect 0 "" "$tissue" "$t/good.cgx"
expect 0 "" "$at/bin/conceg" validate "$t/good.cgx"

# Random walk: nothing leaks, cells restrict, the extracellular space hinders; 2000 walkers know a diffusivity within 2 %.
expect 0 "" "$t/built/random_walk" "$t/good.cgx" 2000 250
cp "$t/stdout" "$t/walk"
expect_output '^leaks 0 of 4000$'
holds "extracellular diffusion is hindered" "$(value extracellular diffusivity) > 0.8 && $(value extracellular diffusivity) < 1.9"
holds "balls of 4.6 um hold their walkers: 1.2 R^2" "$(value soma msd) > 12 && $(value soma msd) < 26"
holds "the tube lets them go along it" "$(value axon msd) > 26"
holds "the hollow cell is wider than a ball" "$(value 'glial process' msd) > $(value soma msd)"
if [ -x "$t/by_pkg_config" ]; then
  expect 0 "" "$t/by_pkg_config" "$t/good.cgx" 2000 250
  expect_same "$t/stdout" "$t/walk"
fi

# Planted defects.
for damage in hole flipped; do
  expect 0 "" "$tissue" "$t/$damage.cgx" "$damage"
  "$t/built/random_walk" "$t/$damage.cgx" 1000 50 > "$expect_folder/stdout" 2> "$expect_folder/stderr"
  code=$?
  holds "$damage: exit code" "$code == 1"
  expect_output '^leaks [1-9][0-9]* of 2000$'
done

expect 0 "" "$t/built/inspect" "$t/good.cgx"
expect_output 'agree$'
holds "fraction by points" "$(value 'intracellular fraction' by.the.meshes,) > 0.3"
"$t/built/inspect" "$t/flipped.cgx" > "$expect_folder/stdout" 2>&1
expect_output 'DO NOT AGREE$'

python=${CONCEG_PYTHON:-python3}
if [ -n "$sanitize" ]; then
  echo "SKIPPED: the part with Python, which does not load sanitized libraries"
elif command -v "$python" > /dev/null; then
  expect 0 "" "$python" "$examples/substrate.py" "$t/good.cgx" --lib "$library"
  expect_output 'somas located in their own cells 8'
  if "$python" -c 'import h5py' 2> /dev/null; then
    holds "values compared" "$(value 'values equal' h5py) > 20000"
  else
    echo "SKIPPED: the part with h5py, which is not here"
  fi
  "$python" "$examples/substrate.py" "$t/flipped.cgx" --lib "$library" > "$expect_folder/stdout" 2>&1
  expect_output 'AssertionError'
else
  echo "SKIPPED: the part with Python, which is not here"
fi
expect_done
