/* SPDX-License-Identifier: BSD-3-Clause
 * HDF5's heaps of variable-length strings. HDF5 1.10 walks through them without a check: a damaged size makes
 * it read beyond its memory or run in a circle. So they are walked here first. */
#define _GNU_SOURCE
#include "h5_internal.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEADER = 16, BLOCK = 1 << 20 };
static const char signature[4] = {'G', 'C', 'O', 'L'};

static int read_at(int fd, void *buffer, size_t count, uint64_t offset) {
  size_t done = 0;
  while (done < count) {
    const ssize_t got = pread(fd, (char *)buffer + done, count - done, (off_t)(offset + done));
    if (got <= 0) return 0;
    done += (size_t)got;
  }
  return 1;
}

static uint64_t number(const unsigned char *bytes, int count) {
  uint64_t value = 0;
  while (count--)
    value = value << 8 | bytes[count];
  return value;
}

/* The objects of one collection fill it, one after the other; number 0 is what is free. */
static int walk(const unsigned char *heap, uint64_t size) {
  uint64_t at = HEADER;
  while (size - at >= HEADER) {
    const uint64_t index = number(heap + at, 2), bytes = number(heap + at + 8, 8), left = size - at;
    if (bytes > left || (!index && bytes < HEADER)) return 0;
    const uint64_t need = index ? HEADER + ((bytes + 7) & ~(uint64_t)7) : bytes;
    if (need > left) return 0;
    at += need;
  }
  return 1;
}

/* The collection that begins at `offset`. `left` bytes may still be walked: honest collections do not
 * overlap, and without a bound those inside others would take time that grows with the square of the file. */
static conceg_status check_collection(int fd, uint64_t offset, uint64_t length, uint64_t *left) {
  unsigned char head[HEADER];
  if (length - offset < HEADER || !read_at(fd, head, HEADER, offset)) return CONCEG_E_FORMAT;
  const uint64_t size = number(head + 8, 8);
  if (size < HEADER || size > length - offset || size > *left) return CONCEG_E_FORMAT;
  *left -= size;
  unsigned char *heap = malloc(size);
  if (!heap) return CONCEG_E_NOMEM;
  const int good = read_at(fd, heap, size, offset) && walk(heap, size);
  free(heap);
  return good ? CONCEG_OK : CONCEG_E_FORMAT;
}

static conceg_status check_all(int fd, uint64_t length, uint64_t *where) {
  unsigned char *block = malloc(BLOCK);
  uint64_t left = length;
  conceg_status status = block ? CONCEG_OK : CONCEG_E_NOMEM;
  /* Blocks overlap, so that no signature is cut in two. */
  for (uint64_t start = 0; status == CONCEG_OK && start < length; start += BLOCK - sizeof signature + 1) {
    const size_t count = length - start < BLOCK ? (size_t)(length - start) : BLOCK;
    if (!read_at(fd, block, count, start)) status = CONCEG_E_IO;
    const unsigned char *at = block;
    while (status == CONCEG_OK &&
           (at = memmem(at, (size_t)(block + count - at), signature, sizeof signature))) {
      *where = start + (uint64_t)(at - block);
      status = check_collection(fd, *where, length, &left);
      at++;
    }
  }
  free(block);
  return status;
}

conceg_status h5_check_heaps(conceg_ctx *ctx, struct h5_file *file, const char *path) {
  if (file->heaps_checked) return CONCEG_OK;
  void *handle = NULL;
  uint64_t where = 0;
  if (H5Fget_vfd_handle(file->id, H5P_DEFAULT, &handle) < 0 || !handle)
    return h5_fail(ctx, CONCEG_E_IO, file->name, path, "cannot be read");
  const conceg_status status = check_all(*(const int *)handle, file->length, &where);
  file->heaps_checked = status == CONCEG_OK;
  if (status == CONCEG_E_NOMEM)
    return conceg_ctx_fail(ctx, status, "%s: %s: out of memory", file->name, path);
  if (status != CONCEG_OK)
    return conceg_ctx_fail(
        ctx, status,
        "%s: %s: expected strings of variable length in a well-formed heap, got sizes that do "
        "not fit at byte %llu",
        file->name, path, (unsigned long long)where);
  return CONCEG_OK;
}
