/* SPDX-License-Identifier: BSD-3-Clause
 * What the fuzz targets share. A target is one function over bytes: libFuzzer searches for those that break
 * it, and runs the files that it is given. */
#ifndef CONCEG_TESTS_FUZZ_H
#define CONCEG_TESTS_FUZZ_H

#include "conceg/conceg.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Ends the run, as a crash does, with the reason. */
#define DEMAND(condition)                                                                                    \
  do {                                                                                                       \
    if (condition) break;                                                                                    \
    fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                                  \
    abort();                                                                                                 \
  } while (0)

/* A bug put there on purpose: the run with CONCEG_FUZZ_PLANT must find it. */
static inline void planted_bug(const uint8_t *data, size_t size) {
#ifdef CONCEG_FUZZ_PLANT
  volatile char small[4] = {0};
  if (size > 2 && data[0] == data[size - 1] && (data[1] & 15) == 9) small[data[1]] = 1;
#else
  (void)data, (void)size;
#endif
}

static inline conceg_ctx *fuzz_ctx(void) {
  static conceg_ctx *ctx;
  if (!ctx) ctx = conceg_ctx_new();
  DEMAND(ctx != NULL);
  conceg_ctx_set_memory(ctx, (uint64_t)64 << 20);
  conceg_ctx_clear_error(ctx);
  return ctx;
}

#endif
