#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Other builds of the same sources.  builds.sh SOURCE FOLDER KIND [PROGRAMS]
#   bare       the libraries and the programs without any stage and without Embree, so without any C++ library
#   sanitized  library, programs and the stages that need no CGAL, VTK or OpenVDB, under ASan and UBSan: their tests
#   sanitized-core  libraries and programs alone under ASan and UBSan, leaks too: their tests
#   thread     libraries and the stages up to relax under TSan: their tests, and small.yaml on two threads
#   clang      everything by clang 14, warnings as errors, its unit tests, and the tissue of PROGRAMS again, byte for byte
set -eu
source=$1 folder=$2 kind=$3
stages="CHARACTERISE IMPORT PLACE TRIANGULATE GROW RELAX MESH SIMULATE FIT ANALYSE EXPORT RENDER REPORT BLOCK"
without() { for stage; do printf -- '-DCONCEG_STAGE_%s=OFF ' "$stage"; done; }
case $kind in
  bare) options="-DCONCEG_TESTS=OFF -DCONCEG_QUERY=OFF $(without $stages)" ;;
  sanitized) options="-DCMAKE_BUILD_TYPE=RelWithDebInfo -DCONCEG_SANITIZE=address,undefined $(without TRIANGULATE MESH EXPORT RENDER)" ;;
  sanitized-core) options="-DCMAKE_BUILD_TYPE=RelWithDebInfo -DCONCEG_SANITIZE=address,undefined $(without $stages)" ;;
  thread) options="-DCMAKE_BUILD_TYPE=RelWithDebInfo -DCONCEG_SANITIZE=thread $(without MESH EXPORT RENDER)" ;;
  clang)
    command -v clang++-14 >/dev/null 2>&1 || { echo "SKIPPED: no clang 14: the sources are not built by it"; exit 77; }
    options="-DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14" ;;
esac
cmake -S "$source" -B "$folder" -G Ninja $options >"$folder.log" 2>&1 || { tail -n 20 "$folder.log"; exit 1; }
ninja -C "$folder" >"$folder.log" 2>&1 || { grep -A 8 'error\|FAILED' "$folder.log" | head -n 60; exit 1; }
"$folder/bin/conceg" --version >/dev/null
# What the sanitizers are told to leave out is part of the result.
suppressions() {
  echo "suppressions in tests/hardening/$1:"
  grep -v '^#' "$source/tests/hardening/$1" | sed 's/^/  /'
}
ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1
UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
LSAN_OPTIONS=suppressions=$source/tests/hardening/address.supp:print_suppressions=0
TSAN_OPTIONS=suppressions=$source/tests/hardening/thread.supp:halt_on_error=1
export ASAN_OPTIONS UBSAN_OPTIONS LSAN_OPTIONS TSAN_OPTIONS
tests() { ctest --test-dir "$folder" "$@" --no-tests=error --output-on-failure; }
case $kind in
  bare)
    if ldd "$folder/bin/conceg" "$folder/lib/libconceg_query.so" | grep -E 'stdc\+\+|CGAL|vtk|openvdb|embree'; then echo "a C++ library is linked"; exit 1; fi
    # A program of a simulator's author links, and is told what is missing.
    ${CC:-cc} -std=c11 -I"$source/libconceg/include" -I"$source/tests" "$source/libconceg/query/tests/absent.c" -o "$folder/absent" \
      -L"$folder/lib" -lconceg_query -lconceg -lm -Wl,-rpath,"$folder/lib"
    "$folder/absent"
    "$folder/bin/conceg" stages ;;
  sanitized-core)
    suppressions address.supp
    tests -j 2 -L 'unit|cli|hardening|query|swc' -LE long
    tests -R 'abi.(plugins|host)' ;;
  thread)
    suppressions thread.supp
    tests -R 'unit.(context|document|substrate|query)'
    "$folder/bin/conceg" run "$source/tests/pipe/small.yaml" --until relax --threads 2 -v -o "$folder/small.cgx"
    "$folder/bin/conceg" validate "$folder/small.cgx" ;;
  clang)
    tests -L unit
    # Two compilers, the same tissue: PROGRAMS of the other build.
    "$folder/bin/conceg" run "$source/tests/pipe/small.yaml" --until relax -q -o "$folder/small.cgx"
    "${4:-$source/build/bin}/conceg" run "$source/tests/pipe/small.yaml" --until relax -q -o "$folder/other.cgx"
    "$folder/bin/conceg" diff "$folder/small.cgx" "$folder/other.cgx" ;;
  *)
    suppressions address.supp
    tests -L unit ;;
esac
