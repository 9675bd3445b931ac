/* SPDX-License-Identifier: BSD-3-Clause
 * libconceg_query where Embree is not: the same calls, which say so. */
#include "conceg/query.h"

conceg_status conceg_query_new(conceg_ctx *ctx, const conceg_substrate *substrate, conceg_query **out) {
  (void)substrate;
  if (out) *out = NULL;
  if (!ctx) return CONCEG_E_UNSUPPORTED;
  return conceg_ctx_fail(
      ctx, CONCEG_E_UNSUPPORTED,
      "query: this libconceg_query was built without Embree: expected Embree 3 (the Debian package "
      "libembree-dev) and a build with CONCEG_QUERY=ON");
}

void conceg_query_free(conceg_query *query) {
  (void)query;
}

conceg_status conceg_query_locate(const conceg_query *query, uint64_t count, const double *point,
                                  int64_t *cell, uint8_t *compartment) {
  (void)query, (void)count, (void)point, (void)cell, (void)compartment;
  return CONCEG_E_UNSUPPORTED;
}

conceg_status conceg_query_intersect(const conceg_query *query, uint64_t count, const double *origin,
                                     const double *direction, const double *length, conceg_hit *out) {
  (void)query, (void)count, (void)origin, (void)direction, (void)length, (void)out;
  return CONCEG_E_UNSUPPORTED;
}
