#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds the fuzz targets with libFuzzer, ASan and UBSan, runs the inputs that once broke them, searches for new ones, and prints
# executions and line coverage of the parsing files.  fuzz.sh SOURCE FOLDER SECONDS SCHEMA.c HDF5-INCLUDE HDF5-LIBRARY YAML-LIBRARY [GLM-INCLUDE [JSON-INCLUDE JSON-LIBRARY]]
# Without GLM the readers of import are left out.
# A crash inside HDF5 itself, below our calls, is counted and kept apart: its 1.10 does not survive every damaged file, which the
# programs turn into an error (apps/contain.h). Any other finding fails the test and stays in FOLDER/found.
source=$1 folder=$2 seconds=$3 schema=$4 hdf5_include=$5 hdf5=$6 yaml=$7 glm=${8-} json_include=${9-} json=${10-}
for tool in clang-14 llvm-profdata-14 llvm-cov-14; do
  command -v $tool > /dev/null || { echo "SKIPPED: no $tool: nothing is fuzzed"; exit 77; }
done
cc=clang-14
command -v ccache > /dev/null && cc="ccache clang-14"
targets="document swc recipe plugin_table" importing=""
[ -z "$glm" ] || targets="$targets import scheme bundles"
parsing="doc model_open digest h5_read h5_type stream texts tree validate validate_form validate_links validate_values array swc swc_file swc_floating swc_parse swc_number swc_link swc_ids swc_tree swc_soma swc_plus yaml grammar recipe node params plugin"
failed=0
mkdir -p "$folder/objects" "$folder/found" || exit 1
cd "$folder" || exit 1
rm -rf found/* ./*.profraw ./*.profdata
flags="-std=gnu11 -w -g -O1 -fno-omit-frame-pointer -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=undefined -fprofile-instr-generate -fcoverage-mapping"
flags="$flags -march=x86-64-v2 -I$source/libconceg/include -I$source/tests -isystem $hdf5_include"
libraries="$hdf5 $yaml -lz -lpthread -ldl -lm"

# ---- Build ----
for file in "$source"/libconceg/src/*.c "$schema"; do
  printf '%s\n' "$file"
done | xargs -P 2 -I{} sh -c "$cc $flags -c {} -o objects/\$(basename {}).o" || exit 1
rm -f libconceg.a && ar rcs libconceg.a objects/*.o || exit 1
link() { clang-14 $flags -I"$source/libconceg/src" "$@" $libraries || exit 1; }
for target in document swc recipe plugin_table; do
  link -fsanitize=fuzzer "$source/tests/fuzz/fuzz_$target.c" libconceg.a -o "fuzz_$target"
done
if [ -n "$glm" ]; then
  importing="scene text_file cactus caterpillar fastpli h5_bundles nfg ply network signal_files signal_document labels npy npz"
  if [ -n "$json" ]; then importing="$importing wmg"; else importing="$importing wmg_absent"; fi
  cxx=$(echo "$cc" | sed 's/clang-14/clang++-14/')
  cxxflags="$(echo "$flags" | sed 's/-std=gnu11/-std=c++17/') -I$source/stages/import -I$source/stages/common ${json_include:+-isystem $json_include}"
  [ "$glm" = /usr/include ] || cxxflags="$cxxflags -isystem $glm"
  for name in $importing; do echo "$source/stages/import/$name.cpp"; done |
    xargs -P 2 -I{} sh -c "$cxx $cxxflags -c {} -o objects/import-\$(basename {}).o" || exit 1
  for plant in "" -DCONCEG_FUZZ_PLANT; do
    clang++-14 $cxxflags $plant -fsanitize=fuzzer "$source/tests/fuzz/fuzz_import.cpp" objects/import-*.o libconceg.a $libraries $json -o "fuzz_import${plant:+_planted}" || exit 1
  done
  clang++-14 $cxxflags -fsanitize=fuzzer "$source/tests/fuzz/fuzz_bundles.cpp" objects/import-*.o libconceg.a $libraries $json -o fuzz_bundles || exit 1
  # The parsers of the simulate stage.
  clang++-14 $cxxflags -fsanitize=fuzzer -I"$source/stages/simulate" "$source/tests/fuzz/fuzz_scheme.cpp" "$source/stages/simulate/scheme_files.cpp" \
    "$source/stages/simulate/protocol.cpp" libconceg.a $libraries -o fuzz_scheme || exit 1
fi
link -DCONCEG_FUZZ_PLANT -fsanitize=fuzzer "$source/tests/fuzz/fuzz_recipe.c" libconceg.a -o planted
link "$source/tests/fuzz/make_seeds.c" libconceg.a -o make_seeds
export LLVM_PROFILE_FILE=/dev/null ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1

# ---- Seeds: small documents, the conformance corpus, fixtures, recipes ----
for target in $targets; do mkdir -p "seeds/$target" "corpus/$target"; done
mkdir -p seeds/bundles
./make_seeds seeds/document seeds/bundles > /dev/null || exit 1
find "$source/spec/conformance" -name '*.cgx' -size -40k -exec cp {} seeds/document/ \; 2> /dev/null
cp "$source"/tests/swc/fixtures/*.swc seeds/swc/
cp "$source"/apps/recipes/*.yaml "$source"/tests/pipe/small.yaml seeds/recipe/
head -c 200 "$source/README.md" > seeds/plugin_table/text
if [ -n "$glm" ]; then
  sh "$source/tests/fuzz/import_seeds.sh" seeds/import || exit 1
  printf 'VERSION: STEJSKALTANNER\n0 0 0 0 0.02 0.005 0.026\n1 0 0 0.1746066 0.02 0.005 0.026\n' > seeds/scheme/pulses
  printf 'VERSION: GRADIENT_WAVEFORM\n4 0.001 0.04 0 0 0.04 0 0 -0.04 0 0 -0.04 0 0\n' > seeds/scheme/waveform
  printf '0 1000 2000\n|0 1 0\n0 0 0.6\n0 0 0.8\n' > seeds/scheme/fsl
fi

# ---- What once broke a target, and a bug that is there on purpose ----
old=0
for target in $targets; do
  [ -d "$source/tests/fuzz/regressions/$target" ] || continue
  for input in "$source/tests/fuzz/regressions/$target"/*; do
    old=$((old + 1))
    "./fuzz_$target" -detect_leaks=0 "$input" > log 2>&1 || { echo "FAILED: $target: $input breaks it again"; tail -30 log; failed=1; }
  done
done
echo "$old inputs that once broke a target: run"
find_planted() { # find_planted PROGRAM SEEDS
  mkdir -p "planted-$1"
  if "./$1" -seed=1 -max_total_time=60 -max_len=400 -artifact_prefix=planted- "planted-$1" "$2" > planted.log 2>&1; then
    echo "FAILED: the bug that was planted in $1 was not found"
    failed=1
  else
    grep -q 'tests/fuzz/fuzz.h' planted.log && echo "the bug planted in $1 was found after $(sed -n 's/^#\([0-9]*\).*/\1/p' planted.log | tail -1) executions" || { echo "FAILED: something else was found than the bug planted in $1"; failed=1; }
  fi
}
find_planted planted seeds/recipe
[ -z "$glm" ] || find_planted fuzz_import_planted seeds/import

# ---- Search ----
search() { # search TARGET: executions to TARGET.executions, findings to found/
  if [ "$1" = document ] || [ "$1" = bundles ]; then # HDF5's own crashes do not end the search
    "./fuzz_$1" -fork=1 -ignore_crashes=1 -ignore_ooms=0 -ignore_timeouts=0 -seed=1 -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=40000 \
      -artifact_prefix=found/$1- "corpus/$1" "seeds/$1" > "$1.log" 2>&1
  else
    "./fuzz_$1" -seed=1 -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=40000 -artifact_prefix=found/$1- "corpus/$1" "seeds/$1" > "$1.log" 2>&1
  fi
  sed -n 's/^#\([0-9]*\).*/\1/p; s/^Done \([0-9]*\) runs.*/\1/p' "$1.log" | tail -1 > "$1.executions"
}
search document & search swc & wait
search recipe & search plugin_table & wait
[ -z "$glm" ] || { search import & search scheme & wait; search bundles; }

# ---- Findings ----
inside=0
for input in found/*; do
  [ -e "$input" ] || continue
  target=$(basename "$input" | sed 's/-\(crash\|oom\|timeout\|leak\|slow\).*//')
  "./fuzz_$target" -detect_leaks=0 -timeout=20 "$input" > log 2>&1 && continue
  # The frame that failed: the first that is of HDF5 or of ours.
  frame=$(grep -E '^ *#[0-9]+ ' log | grep -E -m 1 'libhdf5|libconceg/src|stages/|tests/fuzz')
  case $frame in
    *libhdf5*) inside=$((inside + 1)) ;;
    *) echo "FAILED: $target: $folder/$input breaks it (keep it in tests/fuzz/regressions/$target):"; grep -E -A 12 'ERROR|not so' log | head -30; failed=1 ;;
  esac
done
for target in $targets; do
  printf '%-13s %9s executions in %s s\n' "$target" "$(cat "$target.executions")" "$seconds"
  [ "$(cat "$target.executions" 2> /dev/null || echo 0)" -gt 1000 ] 2> /dev/null || { echo "FAILED: $target hardly ran"; tail -5 "$target.log"; failed=1; }
done
echo "crashes inside HDF5: $inside inputs kept apart"

# ---- Coverage of the parsing files, by the corpora ----
objects=fuzz_document
for target in $targets; do
  LLVM_PROFILE_FILE=$target.profraw "./fuzz_$target" -runs=0 -detect_leaks=0 "corpus/$target" "seeds/$target" > /dev/null 2>&1
  [ "$target" = document ] || objects="$objects -object fuzz_$target"
done
llvm-profdata-14 merge -sparse ./*.profraw -o all.profdata 2> /dev/null && {
  llvm-cov-14 report $objects -instr-profile=all.profdata 2> /dev/null |
    awk -v list=" $parsing $importing " '/(libconceg\/src\/.*\.c|stages\/import\/.*\.cpp) / { name = $1; sub(".*/", "", name); short = name; sub("[.]c(pp)?$", "", short)
        if (index(list, " " short " ")) { printf "%-20s %5d of %5d lines covered, %d %%\n", name, $8 - $9, $8, 100 * ($8 - $9) / $8; all += $8; hit += $8 - $9 } }
      END { printf "parsing files: %d of %d lines covered, %d %%\n", hit, all, all ? 100 * hit / all : 0 }'
}
exit $failed
