/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes of one array: in memory, or in an unlinked file of the temporary folder once the budget is used up.
 */
#ifndef CONCEG_STORE_H
#define CONCEG_STORE_H

#include "conceg/ctx.h"

struct store {
  void *data; /* NULL = nothing stored */
  uint64_t bytes;
  int mapped; /* 1 = lies in a mapped temporary file */
};

/* What a document holds in memory; `used` counts heap bytes only. */
struct budget {
  conceg_ctx *ctx;
  uint64_t used;
};

/* Zeroed storage of `bytes` (at least one is allocated). `path` is for messages. Errors: E_NOMEM, E_IO. */
conceg_status store_new(struct budget *budget, const char *path, uint64_t bytes, struct store *out);
void store_free(struct budget *budget, struct store *store);

/* A new, empty, open file in the temporary folder that has no name any more; -1 with the error set. */
int temporary_file(conceg_ctx *ctx);
/* E_IO when the folder has less than `bytes` left. */
conceg_status check_free_space(conceg_ctx *ctx, const char *folder, uint64_t bytes);

#endif
