/* SPDX-License-Identifier: BSD-3-Clause
 * Trees and single samples beside the soma: kept, left out, or joined to what is nearest. */
#include "swc_internal.h"

#include <math.h>
#include <stdlib.h>

#define MOST_DISTANCES 1e9 /* a few seconds of work */

typedef struct floating {
  swc_index root;
  double distance; /* to the nearest row that is joined to a soma */
  swc_index nearest;
  int joined;
} floating;

/* Every row of a tree, into `rows`, in any order. Returns how many. */
static size_t tree_rows(const conceg_swc *swc, swc_index root, swc_index *rows) {
  size_t count = 1, next;
  rows[0] = root;
  for (next = 0; next < count; next++) {
    swc_index child;
    for (child = swc->first_child[rows[next]]; child >= 0; child = swc->next_sibling[child])
      rows[count++] = child;
  }
  return count;
}

static const char *code_of(const conceg_swc *swc, swc_index root) {
  return swc->first_child[root] < 0 ? "W_POINT" : "W_FLOATING";
}
static const char *name_of(const conceg_swc *swc, swc_index root) {
  return swc->first_child[root] < 0 ? "a single sample joined to nothing"
                                    : "a tree that is not joined to the soma";
}

static void keep(conceg_swc *swc, const floating *tree, size_t count) {
  size_t i;
  for (i = 0; i < count; i++)
    if (swc->soma_count || swc->first_child[tree[i].root] < 0)
      swc_warn(swc, swc->row[tree[i].root].line, code_of(swc, tree[i].root), "%s; kept",
               name_of(swc, tree[i].root));
  if (swc->soma_count > 1 && count) swc->cell_count = swc->soma_count + 1;
}

static void drop(conceg_swc *swc, const floating *tree, size_t count, swc_index *rows) {
  size_t i, k;
  for (i = 0; i < count; i++) {
    const size_t samples = tree_rows(swc, tree[i].root, rows);
    swc_warn(swc, swc->row[tree[i].root].line, code_of(swc, tree[i].root), "%s; left out, %zu sample%s",
             name_of(swc, tree[i].root), samples, samples == 1 ? "" : "s");
    for (k = 0; k < samples; k++)
      swc->merged[rows[k]] = 1;
    swc->use[CONCEG_SWC_USE_DROPPED] += samples;
  }
}

/* A row was joined: it may be the nearest one to trees that are not yet. A soma sample counts from its
 * surface.
 */
static void offer(const conceg_swc *swc, floating *tree, size_t count, swc_index row) {
  const swc_row *const a = &swc->row[row];
  size_t i;
  for (i = 0; i < count; i++) {
    const swc_row *const b = &swc->row[tree[i].root];
    const double x = a->position[0] - b->position[0], y = a->position[1] - b->position[1],
                 z = a->position[2] - b->position[2];
    double distance;
    if (tree[i].joined) continue;
    distance = sqrt(x * x + y * y + z * z);
    if (swc->is_soma[row] && a->radius > 0.0) distance = distance > a->radius ? distance - a->radius : 0.0;
    if (tree[i].nearest < 0 || distance < tree[i].distance)
      tree[i].distance = distance, tree[i].nearest = row;
  }
}

/* The nearest tree first, so that pieces of one broken cable find each other. */
static void attach(conceg_swc *swc, floating *tree, size_t count, swc_index *rows) {
  uint8_t *apart = swc_alloc(swc, swc->row_count, 1);
  size_t i, k, done, best;
  if (!apart) return;
  for (i = 0; i < count; i++)
    for (k = tree_rows(swc, tree[i].root, rows); k-- > 0;)
      apart[rows[k]] = 1;
  for (i = 0; i < swc->row_count; i++)
    if (!apart[i] && !swc->merged[i]) offer(swc, tree, count, (swc_index)i);
  for (done = 0; done < count; done++) {
    for (best = count, i = 0; i < count; i++)
      if (!tree[i].joined && (best == count || tree[i].distance < tree[best].distance)) best = i;
    tree[best].joined = 1;
    swc->parent[tree[best].root] = tree[best].nearest;
    swc_warn(swc, swc->row[tree[best].root].line, code_of(swc, tree[best].root),
             "%s; joined to the %s of line %u, %.3g um away", name_of(swc, tree[best].root),
             swc->is_soma[tree[best].nearest] ? "soma" : "sample", swc->row[tree[best].nearest].line,
             tree[best].distance);
    for (k = tree_rows(swc, tree[best].root, rows); k-- > 0;)
      offer(swc, tree, count, rows[k]);
  }
  free(apart);
  swc_link_children(swc);
}

void swc_settle_floating(conceg_swc *swc, swc_index *scratch) {
  floating *tree;
  size_t count = 0, i;
  for (i = 0; i < swc->row_count; i++)
    count += !swc->merged[i] && !swc->is_soma[i] && swc->parent[i] < 0;
  if (!swc->soma_count) swc_warn(swc, 0, "W_NO_SOMA", "no soma; %zu tree%s", count, count == 1 ? "" : "s");
  if (!count) return;
  tree = swc_alloc(swc, count, sizeof *tree);
  if (!tree) return;
  for (count = i = 0; i < swc->row_count; i++)
    if (!swc->merged[i] && !swc->is_soma[i] && swc->parent[i] < 0)
      tree[count].root = (swc_index)i, tree[count++].nearest = SWC_NONE;
  if (swc->soma_count && (swc->flags & CONCEG_SWC_DROP_FLOATING))
    drop(swc, tree, count, scratch);
  else if (!swc->soma_count || !(swc->flags & CONCEG_SWC_ATTACH_FLOATING))
    keep(swc, tree, count);
  else if ((double)count * (double)swc->row_count > MOST_DISTANCES)
    swc_error(
        swc, swc->row[tree[0].root].line, "E_FLOATING",
        "%zu trees are not joined to the soma, too many to find the nearest sample for each; drop or keep "
        "them",
        count);
  else
    attach(swc, tree, count, scratch);
  free(tree);
}
