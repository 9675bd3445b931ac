/* SPDX-License-Identifier: BSD-3-Clause
 * Memory that runs out at any moment of a reading: E_NOMEM, nothing lost, and the next reading is right
 * again. */
#include "check.h"
#include "conceg/swc.h"

#if !defined(__GLIBC__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
int main(void) {
  SKIP("this C library or this build has an allocator of its own: no failing memory");
}
#else

static long countdown; /* allocations until the one that fails; 0 = none does */
static long alive;     /* allocated and not freed */

static int fails(void) {
  return countdown > 0 && --countdown == 0;
}

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void __libc_free(void *memory);

#pragma GCC visibility push(default) /* the library is to find these */
void *malloc(size_t size) {
  void *const memory = fails() ? NULL : __libc_malloc(size);
  alive += memory != NULL;
  return memory;
}
void *calloc(size_t count, size_t size) {
  void *const memory = fails() ? NULL : __libc_calloc(count, size);
  alive += memory != NULL;
  return memory;
}
void *realloc(void *memory, size_t size) {
  void *const grown = fails() ? NULL : __libc_realloc(memory, size);
  alive += !memory && grown;
  return grown;
}
void free(void *memory) {
  alive -= memory != NULL;
  __libc_free(memory);
}
#pragma GCC visibility pop

static const char text[] = "# species mouse\n9 2 0 6 0 1 1 4 x\n1 1 0 0 0 5 -1\n2 3 6 0 0 1 1 2 3\n3 3 7 0 0 "
                           "1 2\n3 3 7 0 0 1 2\n4 5 8 0 0 1 3\n"
                           "5 6 9 0 0 1 4\n6 6 9 1 0 0 4\n7 1 40 0 0 5 -1\n8 3 60 0 0 1 77\n10 3 61 0 0 1 "
                           "8\n11 1 41 0 0 5 7\n12 2 90 0 0 1 -1\n"
                           "# @begin nodes columns=x,y,z,radius,bar\n# @n 2 0x1.8p+2 0x0p+0 0x0p+0 0x1p+0 "
                           "0x1.8p+1\n# @n 99 - - - - -\n# @end nodes\n";

/* Fails the first, second, ... allocation until none is left to fail. Returns how many there were. */
static long check_each(conceg_ctx *ctx, const char *path, uint32_t flags) {
  long number, before;
  for (number = 1;; number++) {
    conceg_swc *swc = NULL;
    conceg_status status;
    int untouched;
    before = alive;
    countdown = number;
    status = path ? conceg_swc_read(ctx, path, flags, &swc)
                  : conceg_swc_parse(ctx, text, sizeof text - 1, "text", flags, &swc);
    untouched = countdown > 0;
    countdown = 0;
    conceg_swc_free(swc);
    conceg_ctx_error(ctx);
    if (untouched) {
      CHECK_EQUAL(status, CONCEG_OK);
      return number - 1;
    }
    /* The message itself, and the C library's buffers, may fail without harm. */
    if (status != CONCEG_OK) CHECK(status == CONCEG_E_NOMEM || (path && status == CONCEG_E_IO));
    CHECK(alive <= before + 1); /* the context may hold its message */
    if (number > 100000) return number;
  }
}

int main(void) {
  const uint32_t flags[] = {CONCEG_SWC_SPLIT, CONCEG_SWC_SPLIT | CONCEG_SWC_DROP_FLOATING,
                            CONCEG_SWC_SPLIT | CONCEG_SWC_ATTACH_FLOATING};
  const char *const path = "swc_no_memory.swc";
  conceg_ctx *ctx = conceg_ctx_new();
  FILE *file = fopen(path, "wb");
  long count;
  size_t i;
  CHECK(ctx && file && fwrite(text, 1, sizeof text - 1, file) == sizeof text - 1 && fclose(file) == 0);
  for (i = 0; i < sizeof flags / sizeof *flags; i++) {
    count = check_each(ctx, NULL, flags[i]);
    printf("%ld allocations of a text, ", count);
    CHECK(count > 30 && count < 100000);
    count = check_each(ctx, path, flags[i]);
    printf("%ld of a file\n", count);
    CHECK(count > 30 && count < 100000);
  }
  remove(path);
  conceg_ctx_free(ctx);
  return check_done();
}
#endif
