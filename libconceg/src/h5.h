/* SPDX-License-Identifier: BSD-3-Clause
 * The only door to HDF5. Every function takes the one process-wide lock and leaves HDF5's own messages off.
 */
#ifndef CONCEG_H5_H
#define CONCEG_H5_H

#include "tree.h"

struct h5_file;

/* Opens a file read-only; `name` is for messages, `length` its size in bytes (no dataset may claim more). */
conceg_status h5_open(conceg_ctx *ctx, const char *path, const char *name, uint64_t length,
                      struct h5_file **out);
conceg_status h5_close(conceg_ctx *ctx, struct h5_file *file);
const char *h5_name(const struct h5_file *file);

/* Adds everything in the file to the tree: attributes with their values, datasets without. */
conceg_status h5_scan(struct h5_file *file, struct budget *budget, const struct schema *schema,
                      struct entry *root);

/* Rows first .. first + count of a numeric dataset of the file (rank 0: one row). */
conceg_status h5_read_rows(conceg_ctx *ctx, struct h5_file *file, const struct entry *entry, uint64_t first,
                           uint64_t count, void *buffer);
/* All strings of a text dataset of the file. */
conceg_status h5_read_texts(struct budget *budget, struct h5_file *file, const struct entry *entry,
                            struct store *out);

/* Writes the tree as a canonical file into the empty file at `path`, which *fd has open. Values that are not
 * in memory come from `source`. With `anonymous` the name is removed at once. On failure nothing is left at
 * `path`, and *fd is closed and -1. `name` is for messages. */
conceg_status h5_write(conceg_ctx *ctx, const char *path, const char *name, const struct entry *root,
                       struct h5_file *source, int anonymous, int *fd);

#endif
