/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes as a stage's descriptor and table of parameters, and as values for it. What the host accepts must
 * behave. */
#include "fuzz.h"

#include "plugin.h"

#include <math.h>

struct bytes {
  const uint8_t *data;
  size_t size;
};

static uint8_t next(struct bytes *bytes) {
  if (!bytes->size) return 0;
  bytes->size--;
  return *bytes->data++;
}

/* One of a few texts, or some bytes as text; borrowed from `store`. */
static const char *next_text(struct bytes *bytes, char store[24]) {
  static const char *const known[] = {"",    "a",      "step_um", "0.5",   "7",  "true",
                                      "a|b", "/cells", "cells",   "1e999", "-3", "nan"};
  const unsigned pick = next(bytes);
  size_t i;
  if (pick == 255) return NULL;
  if (pick < sizeof known / sizeof *known) return known[pick];
  for (i = 0; i < 23 && i < pick % 23u; i++)
    store[i] = (char)(next(bytes) | 1);
  store[i] = 0;
  return store;
}

static double next_number(struct bytes *bytes) {
  static const double known[] = {0, 1, -1, 1e300, -1e300, 0.5, 9.5};
  const unsigned pick = next(bytes);
  return pick == 255 ? (double)NAN : pick == 254 ? (double)INFINITY : known[pick % 7];
}

static conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  (void)ctx, (void)doc, (void)params;
  return CONCEG_OK;
}

static void ask_for_all(const conceg_stage *stage, const conceg_params *params) {
  for (uint32_t i = 0; stage->params && stage->params[i].name; i++) {
    const conceg_param *row = &stage->params[i];
    const double number = conceg_params_f64(params, row->name);
    if (row->type == CONCEG_PARAM_F64) DEMAND(number >= row->lo && number <= row->hi);
    DEMAND(conceg_params_text(params, row->name) != NULL);
    DEMAND(conceg_params_given(params, row->name) >= 0);
  }
  DEMAND(conceg_params_canonical(params) != NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  enum { ROWS = 12, TEXTS = 4 };
  static char store[ROWS][TEXTS][24], extra[8][24], value[64], assignment[128];
  struct bytes bytes = {data, size};
  conceg_param table[ROWS + 1];
  const char *groups[4];
  conceg_ctx *ctx = fuzz_ctx();
  conceg_stage stage;
  conceg_params *params = NULL;
  planted_bug(data, size);
  memset(&stage, 0, sizeof stage);
  memset(table, 0, sizeof table);
  const unsigned rows = next(&bytes) % ROWS;
  for (unsigned i = 0; i < rows; i++) {
    table[i].name = next_text(&bytes, store[i][0]), table[i].unit = next_text(&bytes, store[i][1]);
    table[i].fallback = next_text(&bytes, store[i][2]), table[i].choices = next_text(&bytes, store[i][3]);
    table[i].type = (int32_t)(next(&bytes) % 9u) - 1, table[i].lo = next_number(&bytes),
    table[i].hi = next_number(&bytes);
  }
  for (unsigned i = 0; i < 3; i++)
    groups[i] = next_text(&bytes, extra[i]);
  groups[3] = NULL;
  stage.abi = CONCEG_STAGE_ABI + next(&bytes) % 2u * (next(&bytes) > 200);
  stage.size = (uint32_t)sizeof stage - (next(&bytes) > 250);
  stage.kind = next(&bytes) > 250 ? NULL : "relax", stage.name = next_text(&bytes, extra[3]);
  stage.version = "1", stage.run = next(&bytes) > 250 ? NULL : run, stage.params = rows ? table : NULL;
  stage.reads = stage.writes = groups;
  if (stage_check(ctx, &stage, "fuzz") != CONCEG_OK) {
    DEMAND(*conceg_ctx_error(ctx));
    return 0;
  }
  snprintf(assignment, sizeof assignment, "relax.%s=%s", rows && table[0].name ? table[0].name : "a",
           next_text(&bytes, value) ? value : "");
  const char *const sets[] = {assignment, NULL};
  if (conceg_params_new(ctx, &stage, NULL, NULL, sets, NULL, &params) == CONCEG_OK)
    ask_for_all(&stage, params);
  conceg_params_free(params);
  DEMAND(conceg_params_new(ctx, &stage, NULL, NULL, NULL, NULL, &params) ==
         CONCEG_OK); /* the defaults of an accepted table fit */
  ask_for_all(&stage, params);
  conceg_params_free(params);
  return 0;
}
