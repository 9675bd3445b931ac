/* SPDX-License-Identifier: BSD-3-Clause
 * The validator: rules about what the numbers mean together: trees without loops, processes that go on in
 * space, labels that name cells, rows of the provenance. */
#define _POSIX_C_SOURCE 200809L
#include "validate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An array of this form, loaded; *out stays NULL when it is absent or of another form (reported already). */
static conceg_status load(struct validator *validator, const char *path, conceg_dtype dtype, uint32_t rank,
                          struct entry **out) {
  struct entry *entry = tree_find(validator->doc->root, path);
  *out = NULL;
  if (!entry || entry->kind != ENTRY_ARRAY || entry->dtype != dtype || entry->rank != rank) return CONCEG_OK;
  const conceg_status status = doc_load(validator->doc, entry);
  if (status == CONCEG_OK && entry->store.data) *out = entry;
  return status;
}

static int offsets_are_sound(const struct entry *offsets, uint64_t rows) {
  const uint64_t *at = offsets->store.data, last = offsets->shape[0] - 1;
  for (uint64_t i = 0; i < last; i++)
    if (at[i] > at[i + 1]) return 0;
  return at[0] == 0 && at[last] == rows;
}

/* ---- Trees ---- */

/* The first row of a tree that is its own ancestor; `count` when there is none. Rows that are known to end at
 * a root carry the mark of an earlier walk. */
static uint64_t find_loop(const int64_t *parent, uint64_t count, uint64_t *mark, uint64_t first) {
  for (uint64_t i = 0; i < count; i++) {
    const uint64_t walk = first + i + 1;
    uint64_t row = i;
    while (!mark[first + row]) {
      mark[first + row] = walk;
      if (parent[row] < 0 || (uint64_t)parent[row] >= count) break; /* a root, or CGX-051 */
      if ((uint64_t)parent[row] == row) break;                      /* CGX-051 too */
      row = (uint64_t)parent[row];
      if (mark[first + row] == walk) return row;
    }
  }
  return count;
}

static conceg_status check_loops(struct validator *validator) {
  static const char path[] = "/dictionary/bar_parent";
  struct entry *parent = NULL, *offsets = NULL;
  if (!is_wanted(validator, path)) return CONCEG_OK;
  conceg_status status = load(validator, path, CONCEG_I64, 1, &parent);
  if (status == CONCEG_OK) status = load(validator, "/dictionary/tree_bar_offset", CONCEG_U64, 1, &offsets);
  if (status != CONCEG_OK || !parent || !offsets || !offsets_are_sound(offsets, parent->shape[0]))
    return status;
  uint64_t *mark = calloc(parent->shape[0] + 1, sizeof *mark);
  if (!mark) return conceg_ctx_fail(validator->ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  const uint64_t *at = offsets->store.data;
  for (uint64_t tree = 0; tree + 1 < offsets->shape[0]; tree++) {
    const uint64_t count = at[tree + 1] - at[tree];
    const int64_t *rows = (const int64_t *)parent->store.data + at[tree];
    const uint64_t row = find_loop(rows, count, mark, at[tree]);
    if (row == count) continue;
    char got[64];
    snprintf(got, sizeof got, "%lld, which leads back to the row", (long long)rows[row]);
    report_value(validator, "CGX-054", MUST, parent, at[tree] + row, 0, "parents that end at a root bar (-1)",
                 got);
    break;
  }
  free(mark);
  return CONCEG_OK;
}

/* ---- Processes that leave a periodic box ---- */

struct cell {
  uint64_t first, count;
  const double *position;
  const int64_t *parent;
};

/* The vector from the parent of a row; 0 for a row without one. */
static int segment_of(const struct cell *cell, uint64_t row, double vector[3]) {
  const int64_t parent = cell->parent[row];
  if (parent < 0 || (uint64_t)parent >= row) return 0;
  for (int k = 0; k < 3; k++)
    vector[k] = cell->position[3 * row + (uint64_t)k] - cell->position[3 * (uint64_t)parent + (uint64_t)k];
  return 1;
}

static double length_of(const double vector[3]) {
  return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

/* 1 when the segment spans more than half a side, and one side less of it would be as short as the cell's
 * others: a process that was folded back into the box, not a long one in a small box. */
static int is_folded(const double vector[3], const double side[3], double others) {
  double folded[3];
  int beyond = 0;
  for (int k = 0; k < 3; k++) {
    const double turns = side[k] > 0 ? nearbyint(vector[k] / side[k]) : 0;
    folded[k] = vector[k] - turns * side[k];
    beyond |= turns != 0;
  }
  return beyond && length_of(vector) > 10 * others && length_of(folded) <= 2 * others;
}

/* The first folded row of the cell; its count when there is none. */
static uint64_t find_folded(const struct cell *cell, const double side[3]) {
  double vector[3], sum = 0;
  uint64_t segments = 0;
  int far = 0;
  for (uint64_t row = 0; row < cell->count; row++) {
    if (!segment_of(cell, row, vector)) continue;
    int beyond = 0;
    for (int k = 0; k < 3; k++)
      beyond |= side[k] > 0 && fabs(vector[k]) > side[k] / 2;
    far |= beyond;
    if (!beyond) sum += length_of(vector), segments++;
  }
  if (!far || !segments) return cell->count;
  for (uint64_t row = 0; row < cell->count; row++)
    if (segment_of(cell, row, vector) && is_folded(vector, side, sum / (double)segments)) return row;
  return cell->count;
}

/* Sides of the periodic axes, 0 for open ones. 0 when there is no sound box. */
static int periodic_sides(const struct validator *validator, double side[3]) {
  const struct entry *root = validator->doc->root, *lo = tree_find(root, "/domain@lo"),
                     *hi = tree_find(root, "/domain@hi"), *periodic = tree_find(root, "/domain@periodic");
  const struct entry *all[3] = {lo, hi, periodic};
  for (int i = 0; i < 3; i++)
    if (!all[i] || all[i]->kind != ENTRY_ARRAY || all[i]->rank != 1 || all[i]->shape[0] != 3 ||
        all[i]->dtype != (i < 2 ? CONCEG_F64 : CONCEG_U8))
      return 0;
  for (int k = 0; k < 3; k++) {
    const double length = ((const double *)hi->store.data)[k] - ((const double *)lo->store.data)[k];
    side[k] = ((const uint8_t *)periodic->store.data)[k] && isfinite(length) && length > 0 ? length : 0;
  }
  return side[0] > 0 || side[1] > 0 || side[2] > 0;
}

static conceg_status check_folding(struct validator *validator) {
  static const char path[] = "/skeleton/position";
  struct entry *position = NULL, *parent = NULL, *offsets = NULL;
  double side[3];
  if (!is_wanted(validator, path) || !periodic_sides(validator, side)) return CONCEG_OK;
  conceg_status status = load(validator, path, CONCEG_F64, 2, &position);
  if (status == CONCEG_OK) status = load(validator, "/skeleton/parent", CONCEG_I64, 1, &parent);
  if (status == CONCEG_OK) status = load(validator, "/skeleton/cell_offset", CONCEG_U64, 1, &offsets);
  if (status != CONCEG_OK || !position || !parent || !offsets || position->shape[1] != 3) return status;
  if (position->shape[0] != parent->shape[0] || !offsets_are_sound(offsets, parent->shape[0])) return status;
  const uint64_t *at = offsets->store.data;
  uint64_t cells = 0, place = 0;
  for (uint64_t i = 0; i + 1 < offsets->shape[0]; i++) {
    const struct cell cell = {.first = at[i],
                              .count = at[i + 1] - at[i],
                              .position = (const double *)position->store.data + 3 * at[i],
                              .parent = (const int64_t *)parent->store.data + at[i]};
    const uint64_t row = find_folded(&cell, side);
    if (row == cell.count) continue;
    if (!cells++) place = cell.first + row;
  }
  if (cells)
    report_value(validator, "CGX-053", MUST, position, 3 * place, cells - 1,
                 "a process that goes on in space", "a jump of about one side of the box from its parent");
  return CONCEG_OK;
}

/* ---- Labels, rows of the provenance ---- */

struct label_check {
  uint64_t cells, broken, first;
  uint32_t got;
};

static conceg_status check_label_block(void *user, uint64_t first, uint64_t count, const void *values) {
  struct label_check *check = user;
  const uint32_t *label = values;
  for (uint64_t i = 0; i < count; i++) {
    if (label[i] <= check->cells || check->broken++) continue;
    check->first = first + i;
    check->got = label[i];
  }
  return CONCEG_OK;
}

static conceg_status check_labels(struct validator *validator) {
  const struct entry *label = tree_find(validator->doc->root, "/volumes/label");
  struct label_check check = {0};
  char expected[64], got[32];
  if (!label || label->kind != ENTRY_ARRAY || label->dtype != CONCEG_U32 ||
      !is_wanted(validator, label->path))
    return CONCEG_OK;
  if (!find_extent(validator, &validator->doc->schema->group[0], "N", &check.cells)) return CONCEG_OK;
  const conceg_status status = doc_each_block(validator->doc, label, check_label_block, &check);
  if (status != CONCEG_OK || !check.broken) return status;
  snprintf(expected, sizeof expected, "at most N = %llu", (unsigned long long)check.cells);
  snprintf(got, sizeof got, "%u", check.got);
  report_value(validator, "CGX-066", MUST, label, check.first, check.broken - 1, expected, got);
  return CONCEG_OK;
}

static conceg_status check_programs(struct validator *validator) {
  static const char *const columns[] = {"/provenance/stage", "/provenance/implementation",
                                        "/provenance/implementation_version", "/provenance/library_version"};
  for (size_t c = 0; c < sizeof columns / sizeof *columns; c++) {
    struct entry *column = NULL;
    if (!is_wanted(validator, columns[c])) continue;
    const conceg_status status = load(validator, columns[c], CONCEG_TEXT, 1, &column);
    if (status != CONCEG_OK) return status;
    for (uint64_t i = 0; column && i < column->shape[0]; i++) {
      const char *text = ((const char *const *)column->store.data)[i];
      if (!strchr(text, '/')) continue;
      report_value(validator, "CGX-072", MUST, column, i, 0, "a name or version, not a path", text);
      break;
    }
  }
  return CONCEG_OK;
}

conceg_status check_tissue(struct validator *validator) {
  conceg_status status = check_loops(validator);
  if (status == CONCEG_OK) status = check_folding(validator);
  if (status == CONCEG_OK) status = check_labels(validator);
  return status == CONCEG_OK ? check_programs(validator) : status;
}
