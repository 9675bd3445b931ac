/* SPDX-License-Identifier: BSD-3-Clause
 * Linked rows to neurite samples in preorder, with the kinds settled and the remarks about the tree's form.
 */
#include "swc_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Children in the order of their ids. */
void swc_link_children(conceg_swc *swc) {
  size_t i;
  for (i = 0; i < swc->row_count; i++)
    swc->first_child[i] = SWC_NONE;
  for (i = swc->row_count; i-- > 0;) {
    const swc_index up = swc->parent[i];
    swc->next_sibling[i] = SWC_NONE;
    if (swc->merged[i] || up < 0) continue;
    swc->next_sibling[i] = swc->first_child[up];
    swc->first_child[up] = (swc_index)i;
  }
}

/* A soma = a soma root and the type-1 rows joined to it by type-1 rows. `stack` has room for every row. */
static void gather_soma(conceg_swc *swc, swc_index root, uint32_t cell, uint64_t *count, swc_index *stack) {
  size_t depth = 1;
  stack[0] = root;
  while (depth) {
    const swc_index row = stack[--depth];
    const size_t base = depth;
    size_t a, b;
    swc_index child;
    swc->is_soma[row] = 1;
    swc->soma_row[(*count)++] = row;
    if (swc->row_cell) swc->row_cell[row] = cell;
    for (child = swc->first_child[row]; child >= 0; child = swc->next_sibling[child])
      if (swc->row[child].kind == CONCEG_SWC_SOMA) stack[depth++] = child;
    for (a = base, b = depth; b > a + 1; a++) {
      const swc_index swap = stack[a];
      stack[a] = stack[--b], stack[b] = swap;
    }
  }
}

static void gather_somas(conceg_swc *swc, swc_index *stack) {
  uint64_t count = 0;
  uint32_t cell = 0;
  size_t i;
  swc->soma_row = swc_alloc(swc, swc->row_count, sizeof *swc->soma_row);
  swc->soma_first = swc_alloc(swc, swc->soma_count + 1, sizeof *swc->soma_first);
  if (swc->soma_count > 1) swc->row_cell = swc_alloc(swc, swc->row_count, sizeof *swc->row_cell);
  for (i = 0; i < swc->row_count && cell < swc->soma_count && !swc->out_of_memory; i++) {
    if (swc->merged[i] || swc->parent[i] >= 0 || swc->row[i].kind != CONCEG_SWC_SOMA) continue;
    gather_soma(swc, (swc_index)i, cell, &count, stack);
    swc->soma_first[++cell] = count;
  }
  swc->use[CONCEG_SWC_USE_SOMA] = count;
}

/* Sorts the first rows of trees by cell, keeping their order within one. */
static void group_by_cell(conceg_swc *swc, swc_index *tree, const uint32_t *cell, size_t count,
                          uint64_t *first) {
  uint64_t *next = swc_alloc(swc, swc->cell_count, sizeof *next);
  swc_index *sorted = swc_alloc(swc, count, sizeof *sorted);
  size_t i;
  uint32_t k;
  if (next && sorted) {
    for (i = 0; i < count; i++)
      next[cell[i]]++;
    for (k = 0, first[0] = 0; k < swc->cell_count; k++)
      first[k + 1] = first[k] + next[k], next[k] = first[k];
    for (i = 0; i < count; i++)
      sorted[next[cell[i]]++] = tree[i];
    memcpy(tree, sorted, count * sizeof *tree);
  }
  free(next), free(sorted);
}

/* First rows of the trees, by cell and within it by id. */
static void find_trees(conceg_swc *swc, swc_index *tree, uint64_t *tree_first) {
  uint32_t *cell = NULL;
  size_t i, count = 0;
  for (i = 0; i < swc->row_count; i++) {
    const swc_index up = swc->parent[i];
    if (!swc->merged[i] && !swc->is_soma[i] && (up < 0 || swc->is_soma[up])) tree[count++] = (swc_index)i;
  }
  tree_first[0] = 0, tree_first[1] = count;
  if (swc->cell_count < 2) return;
  cell = swc_alloc(swc, count, sizeof *cell);
  for (i = 0; cell && i < count; i++) {
    const swc_index up = swc->parent[tree[i]];
    cell[i] = up < 0 ? swc->cell_count - 1 : swc->row_cell[up];
  }
  if (cell) group_by_cell(swc, tree, cell, count, tree_first);
  free(cell);
}

/* The samples of one tree in preorder, from sample `count` on. Returns the new count. */
static uint64_t order_tree(conceg_swc *swc, swc_index root, uint64_t count, swc_index *stack) {
  size_t depth = 0;
  swc_index row = root;
  for (;;) {
    swc_index child = swc->first_child[row];
    swc->sample_row[count++] = row;
    if (child >= 0) {
      /* A sister waits on the stack; it brings its own sister with it. */
      if (row != root && swc->next_sibling[row] >= 0) stack[depth++] = swc->next_sibling[row];
      row = child;
    } else if (row != root && swc->next_sibling[row] >= 0) {
      row = swc->next_sibling[row];
    } else if (depth) {
      row = stack[--depth];
    } else {
      return count;
    }
  }
}

/* Rows of the neurites in preorder, cell by cell. */
static void order_samples(conceg_swc *swc, swc_index *stack) {
  swc_index *tree = swc_alloc(swc, swc->row_count, sizeof *tree);
  uint64_t *tree_first = swc_alloc(swc, swc->cell_count + 1, sizeof *tree_first);
  uint64_t count = 0, i;
  uint32_t cell;
  swc->cell_first = swc_alloc(swc, swc->cell_count + 1, sizeof *swc->cell_first);
  if (!swc->out_of_memory) find_trees(swc, tree, tree_first);
  for (cell = 0; cell < swc->cell_count && !swc->out_of_memory; cell++) {
    for (i = tree_first[cell]; i < tree_first[cell + 1]; i++)
      count = order_tree(swc, tree[i], count, stack);
    swc->cell_first[cell + 1] = count;
  }
  swc->count = swc->use[CONCEG_SWC_USE_SAMPLES] = count;
  free(tree), free(tree_first);
}

/* The kind of a sample, given its parent's: strays of type 1, and the CNIC marks of forks (5) and tips (6).
 */
static int32_t settle_kind(conceg_swc *swc, swc_index row, swc_index parent_sample) {
  const int32_t kind = swc->row[row].kind;
  const swc_index child = swc->first_child[row];
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

static int lies_on(const double a[3], const double b[3]) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void fill_samples(conceg_swc *swc, swc_index *sample_of_row) {
  uint64_t i;
  for (i = 0; i < swc->count; i++) {
    const swc_index row = swc->sample_row[i], up = swc->parent[row];
    const int on_soma = up >= 0 && swc->is_soma[up];
    const swc_index parent = up < 0 || on_soma ? SWC_NONE : sample_of_row[up];
    sample_of_row[row] = (swc_index)i;
    memcpy(swc->position + 3 * i, swc->row[row].position, 3 * sizeof(double));
    swc->radius[i] = swc->row[row].radius;
    swc->line[i] = swc->row[row].line;
    swc->sample_parent[i] = parent;
    swc->on_soma[i] = (uint8_t)on_soma;
    swc->kind[i] = settle_kind(swc, row, parent);
    if (parent < 0) continue;
    if (lies_on(swc->position + 3 * i, swc->position + 3 * parent))
      swc_remark(swc, SWC_NOTE_ZERO_LENGTH, swc->line[i]);
    if (swc->kind[i] != swc->kind[parent] && swc->next_sibling[swc->first_child[up]] < 0)
      swc_warn(swc, swc->line[i], "W_TYPECHANGE", "type changes from %d to %d without a fork",
               (int)swc->kind[parent], (int)swc->kind[i]);
  }
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

/* Somas, the cells they belong to, and what is to become of trees beside them. */
static void tell_cells(conceg_swc *swc, swc_index *scratch) {
  size_t i;
  swc->cell_count = swc->soma_count ? swc->soma_count : 1;
  for (i = 0; i < swc->row_count; i++)
    swc->use[CONCEG_SWC_USE_COPIES] += swc->merged[i];
  swc->use[CONCEG_SWC_USE_ALL] = swc->row_count;
  swc_link_children(swc);
  gather_somas(swc, scratch);
  if (!swc->out_of_memory) swc_settle_floating(swc, scratch);
}

void swc_build_tree(conceg_swc *swc) {
  const size_t rows = swc->row_count;
  swc_index *scratch;
  if (!swc_link_rows(swc)) return;
  swc->first_child = swc_alloc(swc, rows, sizeof(swc_index));
  swc->next_sibling = swc_alloc(swc, rows, sizeof(swc_index));
  swc->is_soma = swc_alloc(swc, rows, 1);
  swc->sample_row = swc_alloc(swc, rows, sizeof(swc_index));
  scratch = swc_alloc(swc, rows, sizeof(swc_index));
  if (!swc->out_of_memory) tell_cells(swc, scratch);
  if (!swc->out_of_memory && !swc->error_count) order_samples(swc, scratch);
  swc->position = swc_alloc(swc, swc->count, 3 * sizeof(double));
  swc->radius = swc_alloc(swc, swc->count, sizeof(double));
  swc->kind = swc_alloc(swc, swc->count, sizeof(int32_t));
  swc->sample_parent = swc_alloc(swc, swc->count, sizeof(int64_t));
  swc->on_soma = swc_alloc(swc, swc->count, 1);
  swc->line = swc_alloc(swc, swc->count, sizeof(uint32_t));
  if (!swc->out_of_memory) {
    fill_samples(swc, scratch);
    swc_find_somas(swc);
    sort_columns(swc);
  }
  free(scratch);
}
