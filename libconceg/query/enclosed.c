/* SPDX-License-Identifier: BSD-3-Clause
 * Cells inside cells. A point that sees the front of a face is outside of that piece of surface, but may
 * still be in a cell around it: a nucleus in a soma, a cell in another one's cavity. No surface lies between
 * the point and the face, so it is enough to know, once and for each connected piece, whether its outside is
 * in a cell. */
#include "scene.h"

#include <math.h>
#include <stdlib.h>

/* Cells entered and not yet left along one ray: cells nest less deep. */
#define OPEN_CELLS 32
/* Faces of a piece that are tried until one gives a sure answer. */
#define TRIES 16
/* Rays from a face begin this far behind it (um), so that a face that touches it is seen too. */
#define START_UM 1e-6

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

int query_enclosing(const conceg_query *query, const double origin[3], const double direction[3],
                    uint64_t own, scene_hit *hit) {
  struct {
    uint32_t cell, entered;
  } open[OPEN_CELLS];
  scene_hit last = {.distance = 0.0, .order = UINT64_MAX}, second;
  int opened = 0, hits = 0, k;
  for (;;) {
    query_scene_trace(query, origin, direction, query->reach, hits ? &last : NULL, hit, &second);
    if (hit->image == UINT32_MAX) return 1;
    /* The same face again: seen from both sides of the box, or the one that the ray starts from. */
    const int again = hits && hit->order == last.order && hit->distance - last.distance < 4.0 * query->margin;
    const int at_origin = hit->order == own && hit->distance < 4.0 * query->margin;
    const int close = hits && !again && hit->distance - last.distance < TIE_UM;
    last = *hit, hits = 1;
    if (again || (at_origin && !close)) continue;
    const double cosine = dot(hit->normal, direction);
    if (close || fabs(cosine) < GRAZING_COSINE) return 0;
    const uint32_t cell = query->surfaces[hit->surface].cell;
    for (k = 0; k < opened && open[k].cell != cell; k++)
      ;
    if (cosine < 0.0) {
      if (k == OPEN_CELLS) return 0;
      if (k == opened) open[opened].cell = cell, open[opened++].entered = 0;
      open[k].entered++;
    } else {
      if (k == opened) return 1;
      if (--open[k].entered == 0) open[k] = open[--opened];
    }
  }
}

static uint32_t find(uint32_t *parent, uint32_t i) {
  while (parent[i] != i)
    i = parent[i] = parent[parent[i]];
  return i;
}

/* parent[v]: vertices joined by faces have one root. */
static void join_pieces(const query_surface *surface, uint32_t vertices, uint32_t *parent) {
  for (uint32_t v = 0; v < vertices; v++)
    parent[v] = v;
  for (uint64_t f = 0; f < surface->face_count; f++)
    for (int k = 1; k < 3; k++) {
      const uint32_t a = find(parent, surface->face[3 * f]),
                     b = find(parent, surface->face[3 * f + (uint64_t)k]);
      if (a < b)
        parent[b] = a;
      else
        parent[a] = b;
    }
}

/* 1, 0: a cell is, none is, in front of the face; -1: this face cannot tell. */
static int front_is_in_cell(const conceg_query *query, const query_surface *surface, uint64_t face) {
  const double *a = surface->vertex + 3 * (uint64_t)surface->face[3 * face],
               *b = surface->vertex + 3 * (uint64_t)surface->face[3 * face + 1],
               *c = surface->vertex + 3 * (uint64_t)surface->face[3 * face + 2];
  double centre[3], normal[3];
  scene_hit hit;
  query_triangle_normal(a, b, c, normal);
  for (int axis = 0; axis < 3; axis++)
    centre[axis] = (a[axis] + b[axis] + c[axis]) / 3.0 - START_UM * normal[axis];
  if (dot(normal, normal) == 0.0) return -1;
  if (!query_enclosing(query, centre, normal, surface->first_face + face, &hit)) return -1;
  return hit.image != UINT32_MAX;
}

enum { UNKNOWN, FREE, ENCLOSED };

/* state[root] for each piece of a surface; returns whether any is enclosed. */
static int judge_pieces(const conceg_query *query, const query_surface *surface, uint32_t *parent,
                        uint8_t *state, uint8_t *tried) {
  int any = 0;
  for (uint64_t f = 0; f < surface->face_count; f++) {
    const uint32_t root = find(parent, surface->face[3 * f]);
    if (state[root] != UNKNOWN || tried[root] == TRIES) continue;
    const int inside = front_is_in_cell(query, surface, f);
    tried[root]++;
    if (inside >= 0) state[root] = inside ? ENCLOSED : FREE;
    any |= inside == 1;
  }
  return any;
}

static conceg_status mark_faces(conceg_ctx *ctx, conceg_query *query, const query_surface *surface,
                                uint32_t *parent, const uint8_t *state) {
  if (!query->enclosed) {
    const query_surface *last = &query->surfaces[query->surface_count - 1];
    query->enclosed = calloc(last->first_face + last->face_count, 1);
    if (!query->enclosed) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "query: out of memory for the faces");
  }
  for (uint64_t f = 0; f < surface->face_count; f++)
    query->enclosed[surface->first_face + f] = state[find(parent, surface->face[3 * f])] == ENCLOSED;
  return CONCEG_OK;
}

static conceg_status find_in_surface(conceg_ctx *ctx, conceg_query *query, const query_surface *surface) {
  uint32_t vertices = 0;
  conceg_status status = CONCEG_OK;
  for (uint64_t i = 0; i < 3 * surface->face_count; i++)
    if (surface->face[i] >= vertices) vertices = surface->face[i] + 1;
  uint32_t *parent = malloc((vertices ? vertices : 1) * sizeof *parent);
  uint8_t *state = calloc(vertices ? vertices : 1, 2);
  if (!parent || !state)
    status = conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "query: out of memory for %u vertices", (unsigned)vertices);
  if (status == CONCEG_OK) {
    join_pieces(surface, vertices, parent);
    if (judge_pieces(query, surface, parent, state, state + vertices))
      status = mark_faces(ctx, query, surface, parent, state);
  }
  free(parent);
  free(state);
  return status;
}

conceg_status query_find_enclosed(conceg_ctx *ctx, conceg_query *query) {
  conceg_status status = CONCEG_OK;
  for (uint64_t s = 0; status == CONCEG_OK && s < query->surface_count; s++)
    status = find_in_surface(ctx, query, &query->surfaces[s]);
  return status;
}
