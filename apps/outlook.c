/* SPDX-License-Identifier: BSD-3-Clause
 * What a run will take. The coefficients are measurements, rounded up. */
#include "outlook.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TWO_PI 6.283185307179586

static const double *read_f64(conceg_doc *doc, const char *path, uint64_t count) {
  conceg_array array = {sizeof array, CONCEG_F64, 0, 0, {0, 0, 0, 0}, NULL, NULL};
  if (!conceg_doc_has(doc, path) || conceg_doc_read(doc, path, &array) != CONCEG_OK) return NULL;
  return array.dtype == CONCEG_F64 && conceg_array_count(&array) == count ? array.data : NULL;
}

static uint64_t rows_of(conceg_doc *doc, const char *path) {
  conceg_array array = {sizeof array, CONCEG_F64, 0, 0, {0, 0, 0, 0}, NULL, NULL};
  return conceg_doc_has(doc, path) && conceg_doc_describe(doc, path, &array) == CONCEG_OK && array.rank
             ? array.shape[0]
             : 0;
}

static double somas_area(conceg_doc *doc) {
  conceg_array array = {sizeof array, CONCEG_F32, 0, 0, {0, 0, 0, 0}, NULL, NULL};
  double area = 0;
  uint64_t i;
  if (!conceg_doc_has(doc, "/cells/radius") || conceg_doc_read(doc, "/cells/radius", &array) != CONCEG_OK)
    return 0;
  if (array.dtype != CONCEG_F32) return 0;
  for (i = 0; i < conceg_array_count(&array); i++) {
    const double radius = (double)((const float *)array.data)[i];
    area += 2 * TWO_PI * radius * radius;
  }
  return area;
}

int outlook_of(conceg_doc *doc, struct outlook *out) {
  const uint64_t bars = rows_of(doc, "/bars/asked_start");
  const double *lo = read_f64(doc, "/domain@lo", 3), *hi = read_f64(doc, "/domain@hi", 3);
  const double *start = read_f64(doc, "/bars/asked_start", bars),
               *end = read_f64(doc, "/bars/asked_end", bars), *radius = read_f64(doc, "/bars/radius", bars),
               *floor = read_f64(doc, "/bars/radius_floor", bars);
  uint64_t i;
  memset(out, 0, sizeof *out);
  if (!bars || !lo || !hi || !start || !end || !radius || !floor) return 0;
  out->volume_um3 = (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]);
  for (i = 0; i < bars; i++) {
    const double length = end[i] - start[i];
    out->cable_um += length;
    out->area_um2 += TWO_PI * length * (radius[i] > floor[i] ? radius[i] : floor[i]);
  }
  out->area_um2 += somas_area(doc);
  return 1;
}

static struct stage_cost cost_of_mesh(const struct outlook *outlook, const conceg_params *params,
                                      int in_part) {
  const double h = conceg_params_f64(params, "h_um"), step = conceg_params_f64(params, "volume_step_um") > 0
                                                                 ? conceg_params_f64(params, "volume_step_um")
                                                                 : 2 * h;
  /* As the stage itself reckons (stages/mesh/README.md), of which simplification leaves a third. */
  const double marched = (conceg_params_bool(params, "cluster") ? 3 : 9) * outlook->area_um2 / (h * h),
               kept = conceg_params_f64(params, "tolerance_um") > 0 ? 0.5 * marched : marched;
  struct stage_cost cost = {0, 0, 0, 0, 0};
  cost.seconds = 1.2e-6 * marched;
  cost.document = 33 * kept;
  if (conceg_params_bool(params, "volumes")) cost.document += 8 * outlook->volume_um3 / (step * step * step);
  cost.temporary = 11 * marched + (in_part ? 0 : 18 * kept);
  cost.part = in_part ? 36 * kept : 0;
  cost.faces = kept;
  return cost;
}

static struct stage_cost cost_of(const struct outlook *outlook, const char *kind, const conceg_params *params,
                                 int in_part) {
  struct stage_cost cost = {1, 0, 0, 0, 0};
  if (!strcmp(kind, "mesh")) return cost_of_mesh(outlook, params, in_part);
  if (!strcmp(kind, "triangulate")) {
    const double nodes = conceg_params_f64(params, "density_per_um3") * outlook->volume_um3;
    cost.seconds = 7.5e-6 * nodes, cost.document = 140 * nodes;
  } else if (!strcmp(kind, "grow")) {
    cost.seconds = 5e-5 * outlook->cable_um, cost.document = 75 * outlook->cable_um;
  } else if (!strcmp(kind, "relax")) {
    cost.seconds = 1.2e-4 * outlook->cable_um * (1 + 0.1 * conceg_params_f64(params, "rounds"));
    cost.document = 90 * outlook->cable_um;
  } else if (!strcmp(kind, "simulate")) {
    const double walkers = conceg_params_f64(params, "walkers"), /* a whole number: its value as f64 too */
        time = conceg_params_f64(params, "separation_ms") + conceg_params_f64(params, "delta_ms");
    cost.seconds = walkers * time / conceg_params_f64(params, "step_ms") / 4e7;
    cost.document = 100 * walkers;
  } else if (!strcmp(kind, "analyse") || !strcmp(kind, "check")) {
    cost.seconds = 2 + 5e-6 * outlook->area_um2;
  } else if (!strcmp(kind, "fit")) {
    cost.seconds = 5;
  }
  return cost;
}

struct stage_cost outlook_cost(const struct outlook *outlook, const char *kind, const conceg_params *params,
                               int in_part) {
  static const struct stage_cost unknown = {1, 0, 0, 0, 0};
  struct stage_cost cost;
  if (!params) return unknown;
  cost = cost_of(outlook, kind, params, in_part);
  /* A plugin of that kind may have other parameters, which are NAN then. */
  return isfinite(cost.seconds + cost.document + cost.temporary + cost.part) ? cost : unknown;
}

void outlook_size_text(char *out, size_t size, double bytes) {
  if (bytes < 1e9)
    snprintf(out, size, "%.0f MB", bytes / 1e6);
  else
    snprintf(out, size, "%.1f GB", bytes / 1e9);
}

void outlook_time_text(char *out, size_t size, double seconds) {
  if (seconds < 90)
    snprintf(out, size, "%.0f s", seconds);
  else if (seconds < 5400)
    snprintf(out, size, "%.0f min", seconds / 60);
  else
    snprintf(out, size, "%.1f h", seconds / 3600);
}
