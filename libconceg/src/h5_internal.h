/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the h5*.c files alone. */
#ifndef CONCEG_H5_INTERNAL_H
#define CONCEG_H5_INTERNAL_H

#include "h5.h"

#include <hdf5.h>

struct h5_file {
  hid_t id;
  uint64_t length;
  char *name;
  int heaps_checked;
};

void h5_lock(void);
void h5_unlock(void);
/* Fails with "name: path: what: HDF5's innermost reason". Call it before any further H5 call. */
conceg_status h5_fail(conceg_ctx *ctx, conceg_status status, const char *name, const char *path,
                      const char *what);
/* File access list: no file locks; with `writing` fixed format bounds. */
hid_t h5_access(int writing);

/* Type in memory (little-endian) of a numeric dtype; not to be closed. */
hid_t h5_memory_type(conceg_dtype dtype);
/* A new fixed-length string type; to be closed. */
hid_t h5_text_type(size_t width, H5T_cset_t cset);

/* Reads all values of an open attribute or dataset. */
herr_t h5_read_all(hid_t object, int attribute, hid_t type, void *buffer);

/* Before a string of variable length is read: E_FORMAT when a heap of the file is damaged. The file is looked
 * through once; `path` is for messages. */
conceg_status h5_check_heaps(conceg_ctx *ctx, struct h5_file *file, const char *path);

#endif
