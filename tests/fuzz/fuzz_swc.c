/* SPDX-License-Identifier: BSD-3-Clause
 * Bytes as an SWC file, by all flags. The samples keep what the header promises, and what is accepted can be
 * written and gives the same samples again. */
#include "fuzz.h"

#include <math.h>
#include <unistd.h>

static void check_samples(const conceg_swc *swc) {
  const uint64_t count = conceg_swc_count(swc);
  const int64_t *parent = conceg_swc_parent(swc);
  for (uint64_t i = 0; i < count; i++) {
    DEMAND(parent[i] >= -1 && parent[i] < (int64_t)i);
    DEMAND(isfinite(conceg_swc_position(swc)[3 * i]) && isfinite(conceg_swc_radius(swc)[i]));
    DEMAND(conceg_swc_on_soma(swc)[i] <= 1 && conceg_swc_line(swc)[i] > 0);
  }
}

static void write_again(conceg_ctx *ctx, const conceg_swc *swc) {
  static char path[64];
  const uint64_t count = conceg_swc_count(swc);
  conceg_swc_cell cell = {.size = sizeof cell,
                          .count = count,
                          .position = conceg_swc_position(swc),
                          .radius = conceg_swc_radius(swc)};
  uint8_t *kind = malloc(count + 1);
  int64_t *parent = malloc((count + 1) * sizeof *parent);
  conceg_swc *again = NULL;
  DEMAND(kind && parent);
  if (!*path) snprintf(path, sizeof path, "/tmp/conceg-fuzz-%ld.swc", (long)getpid());
  for (uint64_t i = 0; i < count; i++) {
    const int32_t code = conceg_swc_kind(swc)[i];
    kind[i] = (uint8_t)(code == 2 || code == 4 || code == 7 ? code : 3);
    parent[i] = conceg_swc_parent(swc)[i] < 0 && !conceg_swc_on_soma(swc)[i] ? CONCEG_SWC_FLOATING
                                                                             : conceg_swc_parent(swc)[i];
  }
  cell.kind = kind, cell.parent = parent;
  if (conceg_swc_soma(swc, cell.soma, &cell.soma_radius) == CONCEG_SOMA_NONE) cell.soma_radius = 0;
  if (conceg_swc_write(ctx, path, &cell) == CONCEG_OK) {
    DEMAND(conceg_swc_read(ctx, path, CONCEG_SWC_STRICT, &again) == CONCEG_OK || *conceg_ctx_error(ctx));
    if (again && conceg_swc_count(again)) {
      DEMAND(conceg_swc_count(again) == count);
      DEMAND(!memcmp(conceg_swc_position(again), cell.position, 24 * count));
      DEMAND(!memcmp(conceg_swc_radius(again), cell.radius, 8 * count));
    }
    conceg_swc_free(again);
    unlink(path);
  }
  free(kind);
  free(parent);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const uint32_t flags[] = {0, CONCEG_SWC_STRICT, CONCEG_SWC_SPLIT | CONCEG_SWC_DROP_FLOATING,
                                   CONCEG_SWC_SPLIT | CONCEG_SWC_ATTACH_FLOATING};
  conceg_ctx *ctx = fuzz_ctx();
  planted_bug(data, size);
  for (size_t f = 0; f < sizeof flags / sizeof *flags; f++) {
    conceg_swc *swc = NULL;
    const conceg_status status = conceg_swc_parse(ctx, (const char *)data, size, "fuzz", flags[f], &swc);
    uint32_t severity, errors = 0;
    for (uint32_t i = 0; swc && conceg_swc_problem(swc, i, &severity, NULL, NULL, NULL); i++)
      errors += severity == 0;
    DEMAND((status == CONCEG_OK) == (errors == 0 && swc));
    if (swc) check_samples(swc);
    if (status == CONCEG_OK && f == 0) write_again(ctx, swc);
    conceg_swc_free(swc);
  }
  return 0;
}
