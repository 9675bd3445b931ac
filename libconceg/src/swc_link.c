/* SPDX-License-Identifier: BSD-3-Clause
 * From ids to row indices: duplicates, parents, cycles, copies of the soma, the root at the soma. */
#include "swc_internal.h"

#include <stdio.h>
#include <stdlib.h>

static int same_row(const swc_row *a, const swc_row *b) {
  return a->kind == b->kind && a->parent_id == b->parent_id && a->radius == b->radius &&
         a->position[0] == b->position[0] && a->position[1] == b->position[1] &&
         a->position[2] == b->position[2];
}

static void find_parents(conceg_swc *swc, const swc_ids *ids) {
  size_t i, first = 0;
  for (i = 0; i < swc->row_count; i++) {
    const swc_row *const row = &swc->row[i];
    /* Rows are in the order of their ids: those of one id are neighbours. */
    if (i && row->id != row[-1].id) first = i;
    swc->parent[i] = SWC_NONE;
    if (first != i) {
      swc->merged[i] = 1;
      if (same_row(row, &swc->row[first]))
        swc_warn(swc, row->line, "W_DUP", "the same sample as in line %u; left out", swc->row[first].line);
      else
        swc_error(swc, row->line, "E_DUP",
                  "id %lld stands in line %u too, with other values; ids must be unique", (long long)row->id,
                  swc->row[first].line);
      continue;
    }
    if (row->parent_id < 0) continue;
    if (row->parent_id == row->id) {
      swc_error(swc, row->line, "E_CYCLE", "sample %lld is its own parent; a root has parent -1",
                (long long)row->id);
      continue;
    }
    swc->parent[i] = i && row->parent_id == row[-1].id && !swc->merged[i - 1]
                         ? (swc_index)i - 1
                         : (swc_index)swc_ids_find(ids, row->parent_id);
    if (swc->parent[i] >= 0) continue;
    if (row->parent_id == 0)
      swc_warn_strict(swc, row->line, "W_ROOT0",
                      "parent is 0 and no sample has the id 0; read as a root, write -1");
    else
      swc_warn_strict(swc, row->line, "W_ORPHAN", "no sample has the id %lld of the parent; read as a root",
                      (long long)row->parent_id);
  }
}

static void report_cycle(conceg_swc *swc, swc_index start) {
  char ids[160] = "";
  size_t used = 0, shown = 0, members = 0;
  swc_index row = start;
  do {
    if (shown < 6)
      used += (size_t)snprintf(ids + used, sizeof ids - used, "%lld -> ", (long long)swc->row[row].id),
          shown++;
    members++, row = swc->parent[row];
  } while (row != start);
  swc_error(swc, swc->row[start].line, "E_CYCLE",
            "%zu samples are each other's ancestors: %s%s%lld; one of them needs parent -1", members, ids,
            members > shown ? "... -> " : "", (long long)swc->row[start].id);
}

/* Walks up from every row; meeting a row of the same walk closes a cycle. */
static void find_cycles(conceg_swc *swc) {
  swc_index *walk;
  size_t i = 0;
  while (i < swc->row_count && swc->parent[i] < (swc_index)i)
    i++;
  if (i == swc->row_count) return; /* parents stand first: no cycle can be */
  walk = swc_alloc(swc, swc->row_count, sizeof *walk);
  if (!walk) return;
  for (i = 0; i < swc->row_count; i++) {
    const swc_index mark = (swc_index)i + 1;
    swc_index row = (swc_index)i;
    while (row >= 0 && !walk[row])
      walk[row] = mark, row = swc->parent[row];
    if (row >= 0 && walk[row] == mark) report_cycle(swc, row);
  }
  free(walk);
}

/* Several soma roots: copies of the first one are merged with it, others belong to other cells. Returns how
 * many cells have a soma root. */
static uint32_t merge_somas(conceg_swc *swc) {
  swc_index first = SWC_NONE;
  uint32_t somata = 0;
  size_t i;
  int copies = 0;
  for (i = 0; i < swc->row_count; i++) {
    const swc_row *const row = &swc->row[i];
    if (swc->merged[i] || swc->parent[i] >= 0 || row->kind != CONCEG_SWC_SOMA) continue;
    if (first < 0) {
      first = (swc_index)i, somata = 1;
    } else if (same_row(&swc->row[first], row)) {
      swc->merged[i] = 1, copies = 1;
      swc_warn(swc, row->line, "W_SOMA_DUP", "the same soma as in line %u; merged with it",
               swc->row[first].line);
    } else if (swc->flags & CONCEG_SWC_SPLIT) {
      swc_warn(swc, row->line, "W_SOMATA", "another soma (the first is in line %u); read as cell %u",
               swc->row[first].line, ++somata);
    } else
      swc_error(
          swc, row->line, "E_SOMATA",
          "a second soma (the first is in line %u); conceg swc repair --somata=split writes a file per cell",
          swc->row[first].line);
  }
  for (i = 0; i < swc->row_count && copies; i++)
    if (swc->parent[i] >= 0 && swc->merged[swc->parent[i]]) swc->parent[i] = first;
  return somata;
}

/* A soma in the middle of a tree: the links from it up to the root are turned round. Returns how many. */
static uint32_t root_at_soma(conceg_swc *swc) {
  swc_index row = 0, previous = SWC_NONE;
  const swc_index rows = (swc_index)swc->row_count;
  while (row < rows && (swc->merged[row] || swc->row[row].kind != CONCEG_SWC_SOMA))
    row++;
  if (row == rows) return 0;
  swc_warn_strict(swc, swc->row[row].line, "W_SOMA_PARENT",
                  "the soma is not the root of its tree; the links up to the root are turned round");
  while (row >= 0) {
    const swc_index next = swc->parent[row];
    swc->parent[row] = previous;
    previous = row, row = next;
  }
  return 1;
}

int swc_link_rows(conceg_swc *swc) {
  swc_ids *ids = swc_ids_new(swc);
  swc->parent = swc_alloc(swc, swc->row_count, sizeof *swc->parent);
  swc->merged = swc_alloc(swc, swc->row_count, 1);
  if (ids && swc->parent && swc->merged) find_parents(swc, ids);
  swc_ids_free(ids);
  if (swc->out_of_memory) return 0;
  find_cycles(swc);
  swc->soma_count = merge_somas(swc);
  if (!swc->soma_count && !swc->error_count) swc->soma_count = root_at_soma(swc);
  return !swc->out_of_memory && !swc->error_count;
}
