/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes of one array: in memory, or in an unlinked file of the temporary folder once the budget is used up.
 */
#define _POSIX_C_SOURCE 200809L
#include "store.h"
#include "partial.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* Arrays below this size always stay in memory. */
static const uint64_t large_array = (uint64_t)4 << 20;

int temporary_file(conceg_ctx *ctx) {
  const char *folder = conceg_ctx_tmpdir(ctx);
  char path[PATH_MAX];
  const int fd = partial_anonymous(folder, path);
  if (fd < 0)
    conceg_ctx_fail(ctx, CONCEG_E_IO,
                    "temporary folder %s: no file can be made there: %s; set TMPDIR to another folder",
                    folder, strerror(errno));
  else if (*path)
    unlink(path);
  return fd;
}

conceg_status check_free_space(conceg_ctx *ctx, const char *folder, uint64_t bytes) {
  struct statvfs info;
  if (statvfs(folder, &info) != 0) return CONCEG_OK; /* the write itself will tell */
  const uint64_t left = (uint64_t)info.f_bavail * (uint64_t)info.f_frsize;
  if (left >= bytes) return CONCEG_OK;
  return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: not enough free space: expected %llu MiB, got %llu MiB",
                         folder, (unsigned long long)((bytes >> 20) + 1), (unsigned long long)(left >> 20));
}

static conceg_status map_file(struct budget *budget, const char *path, uint64_t bytes, struct store *out) {
  conceg_ctx *ctx = budget->ctx;
  const int fd = temporary_file(ctx);
  if (fd < 0) return CONCEG_E_IO;
  /* Reserving the blocks now turns a full disk into an error here instead of a signal later. */
  const int error = posix_fallocate(fd, 0, (off_t)bytes);
  if (error) {
    close(fd);
    return conceg_ctx_fail(ctx, CONCEG_E_IO,
                           "%s: %llu MiB in the temporary folder %s: %s; set TMPDIR to another folder", path,
                           (unsigned long long)(bytes >> 20), conceg_ctx_tmpdir(ctx), strerror(error));
  }
  void *data = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  if (data == MAP_FAILED)
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of address space: %s", path, strerror(errno));
  *out = (struct store){.data = data, .bytes = bytes, .mapped = 1};
  return CONCEG_OK;
}

conceg_status store_new(struct budget *budget, const char *path, uint64_t bytes, struct store *out) {
  if (bytes > (uint64_t)INT64_MAX || bytes > SIZE_MAX)
    return conceg_ctx_fail(budget->ctx, CONCEG_E_NOMEM, "%s: %llu bytes are more than this machine can hold",
                           path, (unsigned long long)bytes);
  const uint64_t limit = conceg_ctx_memory(budget->ctx);
  const int over = bytes > limit || budget->used > limit - bytes;
  if (over && bytes >= large_array) return map_file(budget, path, bytes, out);
  void *data = calloc(bytes ? bytes : 1, 1);
  if (!data)
    return conceg_ctx_fail(budget->ctx, CONCEG_E_NOMEM, "%s: out of memory for %llu bytes", path,
                           (unsigned long long)bytes);
  budget->used += bytes;
  *out = (struct store){.data = data, .bytes = bytes, .mapped = 0};
  return CONCEG_OK;
}

void store_free(struct budget *budget, struct store *store) {
  if (!store->data) return;
  if (store->mapped)
    munmap(store->data, store->bytes);
  else {
    free(store->data);
    if (budget) budget->used -= store->bytes;
  }
  *store = (struct store){0};
}
