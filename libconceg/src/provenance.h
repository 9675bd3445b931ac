/* SPDX-License-Identifier: BSD-3-Clause
 * What the host notes about a stage run: /provenance rows and @made_from of the groups written. */
#ifndef CONCEG_SRC_PROVENANCE_H
#define CONCEG_SRC_PROVENANCE_H

#include "params_internal.h"

#include "conceg/run.h"

/* Adds the row of this run. `input` is the digest of the document before it. */
conceg_status provenance_add(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params,
                             const char *input) CONCEG_NODISCARD;

/* Digests of the groups that a stage reads, "group=digest", ending with NULL. */
struct origins {
  char **line;
  uint32_t count;
};
conceg_status origins_take(conceg_ctx *ctx, conceg_doc *doc, const conceg_stage *stage,
                           struct origins *out) CONCEG_NODISCARD;
void origins_free(struct origins *origins);
/* Writes /group@made_from. */
conceg_status origins_write(conceg_doc *doc, const char *group,
                            const struct origins *origins) CONCEG_NODISCARD;
/* Warns when a group that is about to be read was made from groups that have changed since. */
conceg_status origins_warn(conceg_ctx *ctx, conceg_doc *doc, const char *group) CONCEG_NODISCARD;

/* 1 if `group` is in the NULL-terminated list; names may begin with "/" or not. */
int group_in(const char *const *groups, const char *group);
/* The name without a leading "?" or "/". */
const char *group_name(const char *group);
/* A group of `reads` that may be absent: "?skeleton". */
int group_optional(const char *group);

#endif
