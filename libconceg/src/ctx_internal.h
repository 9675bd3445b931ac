/* SPDX-License-Identifier: BSD-3-Clause
 * What the library's own files know of a context beyond conceg/ctx.h. */
#ifndef CONCEG_CTX_INTERNAL_H
#define CONCEG_CTX_INTERNAL_H

#include "conceg/ctx.h"

struct schema;

/* The compiled spec/schema.yaml, made on first use and kept with the context. NULL (with the error set) when
 * out of memory. */
const struct schema *ctx_schema(conceg_ctx *ctx);

#endif
