/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes in and out: a path, standard input or an image in memory becomes a file that HDF5 can open; a
 * finished file is copied to standard output, a device or memory. No HDF5 here. */
#ifndef CONCEG_STREAM_H
#define CONCEG_STREAM_H

#include "conceg/ctx.h"

/* A readable CGX file with a name in the file system. */
struct input {
  char *path; /* to be opened */
  char *name; /* for messages: the path as given, or "standard input" */
  uint64_t length;
  int temporary; /* the path is ours: input_release unlinks it */
  int held;      /* of a temporary file: the descriptor that keeps it locked */
};

/* `path` "-" = standard input. Checks that the bytes begin like HDF5 and that none is missing or left over.
 */
conceg_status input_open(conceg_ctx *ctx, const char *path, struct input *out);
conceg_status input_from_memory(conceg_ctx *ctx, const void *bytes, size_t count, struct input *out);
void input_release(struct input *input);

/* Copies the whole file behind `fd` to `to`; `name` is that of the target. E_IO with the system's reason. */
conceg_status copy_out(conceg_ctx *ctx, int fd, int to, const char *name);
/* The whole file behind `fd` as bytes that the caller frees. */
conceg_status read_whole(conceg_ctx *ctx, int fd, void **bytes, size_t *count);

#endif
