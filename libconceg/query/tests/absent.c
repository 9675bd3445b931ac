/* SPDX-License-Identifier: BSD-3-Clause
 * A program of a simulator's author against a libconceg_query without Embree: it links, and every call says
 * why not. */
#include "conceg/conceg.h"
#include "conceg/query.h"

#include "check.h"

int main(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_query *query = (conceg_query *)(void *)ctx;
  const double point[3] = {1, 1, 1}, up[3] = {0, 0, 1}, length = 1;
  int64_t cell = 5;
  conceg_hit hit = {.cell = 7};
  CHECK_EQUAL(conceg_query_new(ctx, NULL, &query), CONCEG_E_UNSUPPORTED);
  CHECK(query == NULL);
  CHECK(strstr(conceg_ctx_error(ctx), "libembree-dev") != NULL);
  CHECK_EQUAL(conceg_query_new(NULL, NULL, NULL), CONCEG_E_UNSUPPORTED);
  CHECK_EQUAL(conceg_query_locate(query, 1, point, &cell, NULL), CONCEG_E_UNSUPPORTED);
  CHECK_EQUAL(conceg_query_intersect(query, 1, point, up, &length, &hit), CONCEG_E_UNSUPPORTED);
  CHECK(cell == 5 && hit.cell == 7);
  conceg_query_free(query);
  conceg_ctx_free(ctx);
  return check_done();
}
