/* SPDX-License-Identifier: BSD-3-Clause
 * Rows in the order of their ids, so that the order of lines in the file does not matter, and the row of an
 * id.
 */
#include "swc_internal.h"

#include <stdlib.h>

typedef struct entry {
  int64_t id;
  size_t row;
} entry;

struct swc_ids {
  const swc_row *row;
  size_t count;
};

static int by_id(const void *a, const void *b) {
  const entry *p = a, *q = b;
  if (p->id != q->id) return p->id < q->id ? -1 : 1;
  return p->row < q->row ? -1 : p->row > q->row;
}

static void sort_column(conceg_swc *swc, swc_column *column, const entry *order) {
  double *sorted = swc_alloc(swc, swc->row_count, sizeof *sorted);
  size_t i;
  if (!sorted) return;
  for (i = 0; i < swc->row_count; i++)
    sorted[i] = column->value[order[i].row];
  free(column->value);
  column->value = sorted;
}

void swc_sort_rows(conceg_swc *swc) {
  entry *order;
  swc_row *sorted;
  size_t i;
  if (!swc->unsorted) return;
  order = swc_alloc(swc, swc->row_count, sizeof *order);
  sorted = swc_alloc(swc, swc->row_count, sizeof *sorted);
  if (order && sorted) {
    for (i = 0; i < swc->row_count; i++)
      order[i].id = swc->row[i].id, order[i].row = i;
    qsort(order, swc->row_count, sizeof *order, by_id);
    for (i = 0; i < swc->row_count; i++)
      sorted[i] = swc->row[order[i].row];
    for (i = 0; i < swc->column_count; i++)
      sort_column(swc, &swc->column[i], order);
    free(swc->row);
    swc->row = sorted, swc->row_room = swc->row_count, swc->unsorted = 0;
    sorted = NULL;
  }
  free(order), free(sorted);
}

swc_ids *swc_ids_new(conceg_swc *swc) {
  swc_ids *ids = swc_alloc(swc, 1, sizeof *ids);
  if (ids) ids->row = swc->row, ids->count = swc->row_count;
  return ids;
}

int64_t swc_ids_find(const swc_ids *ids, int64_t id) {
  size_t low = 0, high = ids->count;
  if (!high || id < ids->row[0].id || id > ids->row[high - 1].id) return SWC_NONE;
  /* Without gaps and duplicates the place follows from the id. */
  if ((uint64_t)(id - ids->row[0].id) < high) {
    const size_t guess = (size_t)(id - ids->row[0].id);
    if (ids->row[guess].id == id && (!guess || ids->row[guess - 1].id != id)) return (int64_t)guess;
  }
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (ids->row[middle].id < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < ids->count && ids->row[low].id == id ? (int64_t)low : SWC_NONE;
}

void swc_ids_free(swc_ids *ids) {
  free(ids);
}
