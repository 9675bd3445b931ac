/* SPDX-License-Identifier: BSD-3-Clause
 * Linked rows to neurite samples in preorder, with the kinds settled and the remarks about the tree's form.
 */
#include "swc_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Children in file order. */
static void link_children(conceg_swc *swc) {
  size_t i;
  for (i = 0; i < swc->row_count; i++)
    swc->first_child[i] = swc->next_sibling[i] = SWC_NONE;
  for (i = swc->row_count; i-- > 0;) {
    const int64_t up = swc->parent[i];
    if (swc->merged[i] || up < 0) continue;
    swc->next_sibling[i] = swc->first_child[up];
    swc->first_child[up] = (int64_t)i;
  }
}

/* The soma = the soma root and the type-1 rows joined to it by type-1 rows. `stack` has room for every row.
 */
static void flag_soma(conceg_swc *swc, int64_t *stack) {
  size_t i, depth = 0;
  for (i = 0; i < swc->row_count; i++)
    if (!swc->merged[i] && swc->parent[i] < 0 && swc->row[i].kind == CONCEG_SWC_SOMA)
      stack[depth++] = (int64_t)i;
  while (depth) {
    const int64_t row = stack[--depth];
    int64_t child;
    swc->is_soma[row] = 1;
    for (child = swc->first_child[row]; child >= 0; child = swc->next_sibling[child])
      if (swc->row[child].kind == CONCEG_SWC_SOMA) stack[depth++] = child;
  }
}

/* Rows of the neurites in preorder; children in file order. Returns how many. */
static uint64_t order_samples(conceg_swc *swc, int64_t *stack) {
  uint64_t count = 0;
  size_t i;
  for (i = 0; i < swc->row_count; i++) {
    const int64_t up = swc->parent[i];
    size_t depth = 0;
    if (swc->merged[i] || swc->is_soma[i] || (up >= 0 && !swc->is_soma[up])) continue;
    stack[depth++] = (int64_t)i;
    while (depth) {
      const int64_t row = stack[--depth];
      const size_t base = depth;
      size_t a, b;
      int64_t child;
      swc->sample_row[count++] = row;
      for (child = swc->first_child[row]; child >= 0; child = swc->next_sibling[child])
        stack[depth++] = child;
      for (a = base, b = depth; b > a + 1; a++) {
        const int64_t swap = stack[a];
        stack[a] = stack[--b], stack[b] = swap;
      }
    }
  }
  return count;
}

/* The kind of a sample, given its parent's: strays of type 1, and the CNIC marks of forks (5) and tips (6).
 */
static int32_t settle_kind(conceg_swc *swc, int64_t row, int64_t parent_sample) {
  const int32_t kind = swc->row[row].kind;
  const int64_t child = swc->first_child[row];
  int32_t above;
  if (parent_sample < 0) return kind;
  above = swc->kind[parent_sample];
  if (kind == CONCEG_SWC_SOMA) {
    swc_warn_strict(swc, swc->row[row].line, "W_SOMA_PARENT",
                    "a soma sample below a neurite; read as type %d like its parent", (int)above);
    return above;
  }
  if (kind != above &&
      ((kind == 5 && child >= 0 && swc->next_sibling[child] >= 0) || (kind == 6 && child < 0))) {
    swc_remark(swc, SWC_NOTE_CNIC, swc->row[row].line);
    return above;
  }
  return kind;
}

static void fill_samples(conceg_swc *swc, int64_t *sample_of_row) {
  uint64_t i;
  for (i = 0; i < swc->count; i++) {
    const int64_t row = swc->sample_row[i], up = swc->parent[row];
    const int on_soma = up >= 0 && swc->is_soma[up];
    const int64_t parent = up < 0 || on_soma ? SWC_NONE : sample_of_row[up];
    sample_of_row[row] = (int64_t)i;
    memcpy(swc->position + 3 * i, swc->row[row].position, 3 * sizeof(double));
    swc->radius[i] = swc->row[row].radius;
    swc->line[i] = swc->row[row].line;
    swc->sample_parent[i] = parent;
    swc->on_soma[i] = (uint8_t)on_soma;
    swc->kind[i] = settle_kind(swc, row, parent);
    if (parent < 0) continue;
    if (!memcmp(swc->position + 3 * i, swc->position + 3 * parent, 3 * sizeof(double)))
      swc_remark(swc, SWC_NOTE_ZERO_LENGTH, swc->line[i]);
    if (swc->kind[i] != swc->kind[parent] && swc->next_sibling[swc->first_child[up]] < 0)
      swc_warn(swc, swc->line[i], "W_TYPECHANGE", "type changes from %d to %d without a fork",
               (int)swc->kind[parent], (int)swc->kind[i]);
  }
}

static void remark_roots(conceg_swc *swc, int has_soma) {
  uint64_t i, floating = 0;
  for (i = 0; i < swc->count; i++) {
    if (swc->sample_parent[i] >= 0 || swc->on_soma[i]) continue;
    floating++;
    if (swc->first_child[swc->sample_row[i]] < 0)
      swc_warn(swc, swc->line[i], "W_POINT", "a single sample joined to nothing; kept");
    else if (has_soma)
      swc_warn(swc, swc->line[i], "W_FLOATING", "a tree that is not joined to the soma; kept");
  }
  if (!has_soma)
    swc_warn(swc, 0, "W_NO_SOMA", "no soma; %llu tree%s", (unsigned long long)floating,
             floating == 1 ? "" : "s");
}

/* Columns by row become columns by sample. */
static void sort_columns(conceg_swc *swc) {
  size_t c;
  uint64_t i;
  for (c = 0; c < swc->column_count; c++) {
    double *sorted = swc_alloc(swc, swc->count, sizeof *sorted);
    if (!sorted) return;
    for (i = 0; i < swc->count; i++)
      sorted[i] = swc->column[c].value[swc->sample_row[i]];
    free(swc->column[c].value);
    swc->column[c].value = sorted;
  }
}

void swc_build_tree(conceg_swc *swc) {
  const size_t rows = swc->row_count;
  int64_t *scratch;
  if (!swc_link_rows(swc)) return;
  swc->first_child = swc_alloc(swc, rows, sizeof(int64_t));
  swc->next_sibling = swc_alloc(swc, rows, sizeof(int64_t));
  swc->is_soma = swc_alloc(swc, rows, 1);
  swc->sample_row = swc_alloc(swc, rows, sizeof(int64_t));
  scratch = swc_alloc(swc, rows, sizeof(int64_t));
  if (swc->out_of_memory) {
    free(scratch);
    return;
  }
  link_children(swc);
  flag_soma(swc, scratch);
  swc->count = order_samples(swc, scratch);
  swc->position = swc_alloc(swc, swc->count, 3 * sizeof(double));
  swc->radius = swc_alloc(swc, swc->count, sizeof(double));
  swc->kind = swc_alloc(swc, swc->count, sizeof(int32_t));
  swc->sample_parent = swc_alloc(swc, swc->count, sizeof(int64_t));
  swc->on_soma = swc_alloc(swc, swc->count, 1);
  swc->line = swc_alloc(swc, swc->count, sizeof(uint32_t));
  if (!swc->out_of_memory) {
    fill_samples(swc, scratch);
    swc_find_soma(swc);
    remark_roots(swc, swc->soma_form != CONCEG_SOMA_NONE);
    sort_columns(swc);
  }
  free(scratch);
}
