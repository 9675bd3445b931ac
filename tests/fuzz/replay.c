/* SPDX-License-Identifier: BSD-3-Clause
 * Runs a fuzz target over files: seeds, and inputs that once broke it.  replay FILES... */
#include "fuzz.h"

int main(int argc, char **argv) {
  for (int i = 1; i < argc; i++) {
    FILE *file = fopen(argv[i], "rb");
    uint8_t *bytes = NULL;
    size_t size = 0, got;
    if (!file) {
      fprintf(stderr, "%s: cannot be opened\n", argv[i]);
      return 1;
    }
    do {
      bytes = realloc(bytes, size + 65536);
      DEMAND(bytes != NULL);
      got = fread(bytes + size, 1, 65536, file);
      size += got;
    } while (got);
    fclose(file);
    LLVMFuzzerTestOneInput(bytes, size);
    free(bytes);
  }
  printf("%d inputs, none breaks the target\n", argc - 1);
  return argc < 2;
}
