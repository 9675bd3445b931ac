/* SPDX-License-Identifier: BSD-3-Clause
 * The validator: rules that tie arrays together: rows within a cell, faces and vertices of a surface, places
 * in the box. */
#define _POSIX_C_SOURCE 200809L
#include "validate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Offsets that can be trusted: start at 0, never fall. `rows` of them, plus one. */
struct offsets {
  const uint64_t *at;
  uint64_t rows;
};

static struct entry *find_array(const struct validator *validator, const char *path, conceg_dtype dtype,
                                uint32_t rank) {
  struct entry *entry = tree_find(validator->doc->root, path);
  return entry && entry->kind == ENTRY_ARRAY && entry->dtype == dtype && entry->rank == rank ? entry : NULL;
}

/* at stays NULL when the array is absent or wrong, which other rules have reported. */
static conceg_status load_offsets(struct validator *validator, const char *path, struct offsets *out) {
  struct entry *entry = find_array(validator, path, CONCEG_U64, 1);
  *out = (struct offsets){0};
  if (!entry || !entry->shape[0]) return CONCEG_OK;
  const conceg_status status = doc_load(validator->doc, entry);
  if (status != CONCEG_OK) return status;
  const uint64_t *at = entry->store.data;
  for (uint64_t i = 1; i < entry->shape[0]; i++)
    if (at[i] < at[i - 1]) return CONCEG_OK;
  if (at[0] == 0) *out = (struct offsets){.at = at, .rows = entry->shape[0] - 1};
  return CONCEG_OK;
}

/* A row that names another row of the same cell (or tree, or surface). */
enum { BEFORE_OWN, ANY_OTHER, ANY_OF_TARGET };
struct row_rule {
  const char *rule, *path, *offsets, *target; /* target: offsets that bound the value; NULL = the own ones */
  int kind, none;                             /* none: -1 is allowed */
  const char *expected;
};

static const struct row_rule row_rules[] = {
    {"CGX-051", "/dictionary/bar_parent", "/dictionary/tree_bar_offset", NULL, ANY_OTHER, 1,
     "another row of its tree, or -1"},
    {"CGX-050", "/bars/parent", "/bars/cell_offset", NULL, BEFORE_OWN, 1,
     "an earlier row of its cell, or -1"},
    {"CGX-051", "/bars/handed_to", "/bars/cell_offset", NULL, ANY_OTHER, 1, "another row of its cell, or -1"},
    {"CGX-050", "/skeleton/parent", "/skeleton/cell_offset", NULL, BEFORE_OWN, 1,
     "an earlier row of its cell, or -1"},
    {"CGX-052", "/skeleton/bar", "/skeleton/cell_offset", "/bars/cell_offset", ANY_OF_TARGET, 0,
     "a row of its cell's bars"},
    {"CGX-052", "/spheres/segment_end", "/spheres/cell_offset", "/skeleton/cell_offset", ANY_OF_TARGET, 1,
     "a row of its cell's skeleton, or -1"}};

struct row_check {
  const struct row_rule *rule;
  const struct entry *entry;
  struct offsets own, target;
  uint64_t cell; /* of the row at hand */
  uint64_t broken, first;
  char got[64];
};

static int row_is_broken(const struct row_rule *rule, int64_t value, uint64_t own, uint64_t limit) {
  if (value < 0) return !(rule->none && value == -1);
  const uint64_t row = (uint64_t)value;
  return row >= limit || (rule->kind != ANY_OF_TARGET && row == own);
}

static conceg_status check_rows(void *user, uint64_t first, uint64_t count, const void *values) {
  struct row_check *check = user;
  const int wide = check->entry->dtype == CONCEG_I64;
  for (uint64_t i = 0; i < count; i++) {
    const uint64_t row = first + i;
    while (check->cell < check->own.rows && row >= check->own.at[check->cell + 1])
      check->cell++;
    if (check->cell == check->own.rows) return CONCEG_OK; /* rows past the last offset: CGX-042 */
    const uint64_t start = check->own.at[check->cell], own = row - start;
    uint64_t limit = check->own.at[check->cell + 1] - start;
    if (check->rule->kind == BEFORE_OWN) limit = own;
    if (check->rule->kind == ANY_OF_TARGET)
      limit = check->target.at[check->cell + 1] - check->target.at[check->cell];
    const int64_t value = wide ? ((const int64_t *)values)[i] : (int64_t)((const uint32_t *)values)[i];
    if (!row_is_broken(check->rule, value, own, limit) || check->broken++) continue;
    check->first = row;
    snprintf(check->got, sizeof check->got, "%lld", (long long)value);
  }
  return CONCEG_OK;
}

static conceg_status check_row_rule(struct validator *validator, const struct row_rule *rule) {
  struct row_check check = {.rule = rule, .entry = find_array(validator, rule->path, CONCEG_I64, 1)};
  if (!check.entry) check.entry = find_array(validator, rule->path, CONCEG_U32, 1);
  if (!check.entry || !is_wanted(validator, rule->path)) return CONCEG_OK;
  conceg_status status = load_offsets(validator, rule->offsets, &check.own);
  if (status == CONCEG_OK && rule->target) status = load_offsets(validator, rule->target, &check.target);
  if (status != CONCEG_OK || !check.own.at) return status;
  if (rule->target && (!check.target.at || check.target.rows != check.own.rows)) return CONCEG_OK;
  status = doc_each_block(validator->doc, check.entry, check_rows, &check);
  if (status == CONCEG_OK && check.broken)
    report_value(validator, rule->rule, MUST, check.entry, check.first, check.broken - 1, rule->expected,
                 check.got);
  return status;
}

/* Surfaces: faces name vertices of their own surface; vertices are their origin plus a float32. */
struct surface_check {
  struct offsets faces, vertices;
  const double *origin;
  uint64_t surface, broken, first;
  char got[96];
};

static conceg_status check_faces(void *user, uint64_t first, uint64_t count, const void *values) {
  struct surface_check *check = user;
  const uint32_t *corner = values;
  for (uint64_t i = 0; i < count;) {
    const uint64_t face = (first + i) / 3;
    while (check->surface < check->faces.rows && face >= check->faces.at[check->surface + 1])
      check->surface++;
    if (check->surface == check->faces.rows) return CONCEG_OK;
    const uint64_t limit = check->vertices.at[check->surface + 1] - check->vertices.at[check->surface];
    uint64_t end = (check->faces.at[check->surface + 1]) * 3 - first, wrong = 0;
    if (end > count) end = count;
    for (uint64_t k = i; k < end; k++)
      wrong += corner[k] >= limit;
    for (uint64_t k = i; wrong && !check->broken && k < end; k++)
      if (corner[k] >= limit) {
        check->first = first + k;
        snprintf(check->got, sizeof check->got, "%u in a surface of %llu vertices", corner[k],
                 (unsigned long long)limit);
        break;
      }
    check->broken += wrong;
    i = end;
  }
  return CONCEG_OK;
}

static int is_rounded(double value, double origin) {
  return origin + (double)(float)(value - origin) == value;
}

static conceg_status check_vertices(void *user, uint64_t first, uint64_t count, const void *values) {
  struct surface_check *check = user;
  const double *vertex = values;
  for (uint64_t i = 0; i + 3 <= count; i += 3) {
    const uint64_t row = (first + i) / 3;
    while (check->surface < check->vertices.rows && row >= check->vertices.at[check->surface + 1])
      check->surface++;
    if (check->surface == check->vertices.rows) return CONCEG_OK;
    const double *origin = check->origin + 3 * check->surface;
    for (uint64_t k = 0; k < 3; k++) {
      if (is_rounded(vertex[i + k], origin[k]) || check->broken++) continue;
      check->first = first + i + k;
      snprintf(check->got, sizeof check->got, "%.17g with origin %.17g", vertex[i + k], origin[k]);
    }
  }
  return CONCEG_OK;
}

static conceg_status check_surfaces(struct validator *validator) {
  struct surface_check check = {0};
  conceg_status status = load_offsets(validator, "/meshes/face_offset", &check.faces);
  if (status == CONCEG_OK) status = load_offsets(validator, "/meshes/vertex_offset", &check.vertices);
  if (status != CONCEG_OK || !check.vertices.at) return status;
  const struct entry *face = find_array(validator, "/meshes/face", CONCEG_U32, 2);
  if (face && face->shape[1] == 3 && check.faces.at && check.faces.rows == check.vertices.rows) {
    status = doc_each_block(validator->doc, face, check_faces, &check);
    if (status == CONCEG_OK && check.broken)
      report_value(validator, "CGX-060", MUST, face, check.first, check.broken - 1,
                   "a vertex of its own surface", check.got);
  }
  struct entry *origin = find_array(validator, "/meshes/origin", CONCEG_F64, 2);
  const struct entry *vertex = find_array(validator, "/meshes/vertex", CONCEG_F64, 2);
  if (status != CONCEG_OK || !origin || origin->shape[0] != check.vertices.rows || origin->shape[1] != 3)
    return status;
  if (!vertex || vertex->shape[1] != 3 || (status = doc_load(validator->doc, origin)) != CONCEG_OK)
    return status;
  check.origin = origin->store.data;
  check.surface = check.broken = 0;
  status = doc_each_block(validator->doc, vertex, check_vertices, &check);
  if (status == CONCEG_OK && check.broken)
    report_value(validator, "CGX-061", MUST, vertex, check.first, check.broken - 1,
                 "the surface's origin plus a float32", check.got);
  return status;
}

/* The box and what must lie in it. */
struct box_check {
  double lo[3], hi[3];
  uint8_t periodic[3];
  uint64_t broken, first;
  char got[64];
};

static conceg_status check_places(void *user, uint64_t first, uint64_t count, const void *values) {
  struct box_check *check = user;
  const double *place = values;
  for (uint64_t i = 0; i + 3 <= count; i += 3)
    for (uint64_t k = 0; k < 3; k++) {
      const double x = place[i + k];
      if ((x >= check->lo[k] && (check->periodic[k] ? x < check->hi[k] : x <= check->hi[k])) || !isfinite(x))
        continue;
      if (check->broken++) continue;
      check->first = first + i + k;
      format_number(CONCEG_F64, values, i + k, check->got);
    }
  return CONCEG_OK;
}

static const struct entry *domain_attribute(const struct validator *validator, const char *path,
                                            conceg_dtype dtype) {
  const struct entry *entry = find_array(validator, path, dtype, 1);
  return entry && entry->shape[0] == 3 ? entry : NULL;
}

static conceg_status check_box(struct validator *validator) {
  static const char *const inside[] = {"/cells/soma", "/network/position"};
  const struct entry *los = domain_attribute(validator, "/domain@lo", CONCEG_F64),
                     *his = domain_attribute(validator, "/domain@hi", CONCEG_F64),
                     *wraps = domain_attribute(validator, "/domain@periodic", CONCEG_U8);
  struct box_check check = {0};
  char expected[64], got[64];
  if (!los || !his || !wraps) return CONCEG_OK;
  const double *lo = los->store.data, *hi = his->store.data;
  const uint8_t *periodic = wraps->store.data;
  for (unsigned k = 0; k < 3; k++) {
    snprintf(expected, sizeof expected, "a value above /domain@lo = %.17g", lo[k]);
    format_number(CONCEG_F64, hi, k, got);
    if (!(hi[k] > lo[k])) report_value(validator, "CGX-062", MUST, his, k, 0, expected, got);
    format_number(CONCEG_U8, periodic, k, got);
    if (periodic[k] > 1) report_value(validator, "CGX-063", MUST, wraps, k, 0, "0 or 1", got);
  }
  memcpy(check.lo, lo, sizeof check.lo);
  memcpy(check.hi, hi, sizeof check.hi);
  memcpy(check.periodic, periodic, sizeof check.periodic);
  conceg_status status = CONCEG_OK;
  for (size_t i = 0; i < sizeof inside / sizeof *inside && status == CONCEG_OK; i++) {
    const struct entry *entry = find_array(validator, inside[i], CONCEG_F64, 2);
    if (!entry || entry->shape[1] != 3 || !is_wanted(validator, inside[i])) continue;
    check.broken = 0;
    status = doc_each_block(validator->doc, entry, check_places, &check);
    if (status == CONCEG_OK && check.broken)
      report_value(validator, "CGX-064", SHOULD, entry, check.first, check.broken - 1,
                   "a place in the box of /domain", check.got);
  }
  return status;
}

conceg_status check_links(struct validator *validator) {
  conceg_status status = check_box(validator);
  for (size_t i = 0; i < sizeof row_rules / sizeof *row_rules && status == CONCEG_OK; i++)
    status = check_row_rule(validator, &row_rules[i]);
  if (status == CONCEG_OK && is_wanted(validator, "/meshes")) status = check_surfaces(validator);
  return status;
}
