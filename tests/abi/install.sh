#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# An install works, also after it was moved: programs, CMake package, pkg-config file, folder of plugins.
# install.sh SOURCE BUILD PLUGINS CC [SANITIZERS]
source=$1 build=$2 plugins=$3 cc=$4 sanitize=${5:+-fsanitize=$5}
. "$source/tests/cli/expect.sh"
t=$expect_folder
unset CONCEG_STAGE_PATH LD_LIBRARY_PATH
cmake --install "$build" --prefix "$t/first" > "$t/log" 2>&1 || { cat "$t/log"; exit 1; }
mv "$t/first" "$t/moved"
at=$t/moved
PATH=$at/bin:$PATH
export PATH
expect 0 "" conceg version
expect 0 "" conceg help run
library=$(dirname "$(find "$at" -name libconceg.so)")
expect_true "there is a folder of plugins" test -d "$library/conceg/plugins"
expect_true "the libraries find each other by themselves" sh -c "ldd '$library/libconceg_query.so' | grep -q 'libconceg.so.0 => $library/'"
expect_true "no static library is installed" sh -c "test -z \"\$(find '$at' -name '*.a')\""
expect_true "nothing installed names the folders of the build" sh -c "! grep -rlF -e '$build/' --include='*.cmake' --include='*.pc' '$at'"

# DESTDIR puts the same files under another root, for packagers.
DESTDIR=$t/root cmake --install "$build" --prefix /opt/conceg > "$t/log" 2>&1 || { cat "$t/log"; exit 1; }
expect_true "DESTDIR gives the same files" sh -c "(cd '$at' && find . | sort) > '$t/a' && (cd '$t/root/opt/conceg' && find . | sort) > '$t/b' && cmp '$t/a' '$t/b'"
expect 0 "" "$t/root/opt/conceg/bin/conceg" version

# The template against the install, put where the install looks.
cmake -S "$source/stages/template" -B "$t/built" -DCMAKE_PREFIX_PATH="$at" -DCMAKE_C_COMPILER="$cc" > "$t/log" 2>&1 &&
  cmake --build "$t/built" >> "$t/log" 2>&1 || { cat "$t/log"; exit 1; }
cp "$t/built/libconceg_stage_relax_template.so" "$plugins/libconceg_stage_place_toy.so" "$library/conceg/plugins/"
printf 'conceg: 1\ndomain:\n  size_um: [20, 20, 20]\nplace: {impl: toy}\n' > "$t/toy.yaml"
expect 0 "" conceg place -p "$t/toy.yaml" -o "$t/toy.cgx"
expect 0 "" conceg relax --impl template "$t/toy.cgx" -o "$t/thin.cgx"
expect 0 "" conceg validate "$t/thin.cgx"

# A program of a simulator's author.
cat > "$t/user.c" <<'S'
#include <conceg/conceg.h>
#include <stdio.h>
int main(int argc, char **argv) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = NULL;
  const int good = argc == 2 && conceg_doc_open(ctx, argv[1], &doc) == CONCEG_OK && conceg_doc_has(doc, "/cells/soma");
  printf("%s %s\n", conceg_version(), good ? "opened" : conceg_ctx_error(ctx));
  if (doc && conceg_doc_close(doc) != CONCEG_OK) return 1;
  conceg_ctx_free(ctx);
  return !good;
}
S
if command -v pkg-config > /dev/null; then
  PKG_CONFIG_PATH=$library/pkgconfig
  export PKG_CONFIG_PATH
  expect_true "a C program builds with pkg-config" "$cc" $sanitize "$t/user.c" -o "$t/user" $(pkg-config --cflags --libs conceg) -Wl,-rpath,"$library"
  expect 0 "" "$t/user" "$t/thin.cgx"
  expect_output "opened"
else
  echo "SKIPPED: the part with pkg-config, which is not here"
fi
expect_done
