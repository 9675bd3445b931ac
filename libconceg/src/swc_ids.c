/* SPDX-License-Identifier: BSD-3-Clause
 * Which row has an id: a table when the ids are dense, else a sorted list. */
#include "swc_internal.h"

#include <stdlib.h>

typedef struct entry {
  int64_t id, row;
} entry;

struct swc_ids {
  int64_t lowest, span; /* of the table */
  int64_t *table;       /* first row with the id, SWC_NONE = none */
  entry *sorted;
  size_t count;
};

static int by_id(const void *a, const void *b) {
  const entry *p = a, *q = b;
  if (p->id != q->id) return p->id < q->id ? -1 : 1;
  return p->row < q->row ? -1 : p->row > q->row;
}

swc_ids *swc_ids_new(conceg_swc *swc) {
  swc_ids *ids = swc_alloc(swc, 1, sizeof *ids);
  int64_t lowest = INT64_MAX, highest = INT64_MIN;
  size_t i;
  if (!ids) return NULL;
  ids->count = swc->row_count;
  for (i = 0; i < ids->count; i++) {
    if (swc->row[i].id < lowest) lowest = swc->row[i].id;
    if (swc->row[i].id > highest) highest = swc->row[i].id;
  }
  if (ids->count && lowest >= 0 && highest - lowest < (int64_t)(4 * ids->count + 1024)) {
    ids->lowest = lowest, ids->span = highest - lowest + 1;
    ids->table = swc_alloc(swc, (size_t)ids->span, sizeof *ids->table);
    for (i = 0; ids->table && i < (size_t)ids->span; i++)
      ids->table[i] = SWC_NONE;
    for (i = ids->count; ids->table && i-- > 0;)
      ids->table[swc->row[i].id - lowest] = (int64_t)i;
  } else {
    ids->sorted = swc_alloc(swc, ids->count, sizeof *ids->sorted);
    for (i = 0; ids->sorted && i < ids->count; i++)
      ids->sorted[i].id = swc->row[i].id, ids->sorted[i].row = (int64_t)i;
    if (ids->sorted) qsort(ids->sorted, ids->count, sizeof *ids->sorted, by_id);
  }
  if (swc->out_of_memory) {
    swc_ids_free(ids);
    return NULL;
  }
  return ids;
}

int64_t swc_ids_find(const swc_ids *ids, int64_t id) {
  size_t low = 0, high = ids->count;
  if (ids->table)
    return id < ids->lowest || id - ids->lowest >= ids->span ? SWC_NONE : ids->table[id - ids->lowest];
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (ids->sorted[middle].id < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < ids->count && ids->sorted[low].id == id ? ids->sorted[low].row : SWC_NONE;
}

void swc_ids_free(swc_ids *ids) {
  if (!ids) return;
  free(ids->table), free(ids->sorted), free(ids);
}
