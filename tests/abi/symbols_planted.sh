#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What symbols.sh must find: a function without a library, a changed constant, a larger structure, a lost symbol.
# symbols_planted.sh SOURCE BUILD CC
source=$1 build=$2 cc=$3
. "$source/tests/cli/expect.sh"
t=$expect_folder
mkdir -p "$t/copy/libconceg" "$t/copy/tests/abi" "$t/copy/spec"
cp -r "$source/libconceg/include" "$t/copy/libconceg/"
header() { cp "$source/libconceg/include/conceg/$1" "$t/copy/libconceg/include/conceg/$1"; }
check() { sh "$source/tests/abi/symbols.sh" "$t/copy" "$build" "$cc"; }
cp "$source/spec/symbols.tsv" "$t/copy/spec/"
expect 0 "" check
sed -i 's/^#endif$/CONCEG_API int conceg_not_there(void);\n#endif/' "$t/copy/libconceg/include/conceg/geom.h" && sed -i 's/#include <stdint.h>/#include "conceg\/base.h"\n#include <stdint.h>/' "$t/copy/libconceg/include/conceg/geom.h"
expect_true "a function of a header alone is found" sh -c "! sh '$source/tests/abi/symbols.sh' '$t/copy' '$build' '$cc' > '$t/log'; grep -q 'not exported: conceg	conceg_not_there' '$t/log'"
header geom.h
sed -i 's/CONCEG_VESSEL = 21/CONCEG_VESSEL = 22/' "$t/copy/libconceg/include/conceg/model.h"
expect_true "a changed value is found" sh -c "! sh '$source/tests/abi/symbols.sh' '$t/copy' '$build' '$cc' > '$t/log'; grep -q 'CONCEG_VESSEL' '$t/log'"
header model.h
sed -i 's/  double distance;/  double distance, more;/' "$t/copy/libconceg/include/conceg/query.h"
expect_true "a larger structure is found" sh -c "! sh '$source/tests/abi/symbols.sh' '$t/copy' '$build' '$cc' > '$t/log'; grep -q 'conceg_hit' '$t/log'"
header query.h
printf 'function\tconceg_gone\tconceg\t0.1\n' >> "$t/copy/spec/symbols.tsv"
expect_true "a lost function is found" sh -c "! sh '$source/tests/abi/symbols.sh' '$t/copy' '$build' '$cc' > '$t/log'; grep -q 'conceg_gone' '$t/log'"
expect_done
