/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene.h"

#include <math.h>
#include <stdlib.h>

/* Directions of locate, tried in this order; arbitrary, so that they are parallel to no face of a regular
 * mesh. */
static const double directions[][3] = {
    {0.5320, 0.3970, 0.7479},   {-0.6710, 0.2890, 0.6829},   {0.2110, -0.8430, 0.4947},
    {0.8830, 0.1370, -0.4490},  {-0.3190, -0.5570, -0.7668}, {0.0970, 0.9410, -0.3242},
    {-0.9290, 0.0830, -0.3607}, {0.4410, -0.3010, -0.8455},
};
#define DIRECTIONS (sizeof directions / sizeof directions[0])

conceg_status conceg_query_new(conceg_ctx *ctx, const conceg_substrate *substrate, conceg_query **out) {
  conceg_query *query;
  conceg_status status;
  uint64_t s, faces = 0;
  if (!out) return CONCEG_E_USAGE;
  *out = NULL;
  if (!ctx || !substrate) return CONCEG_E_USAGE;
  if (conceg_substrate_meshes(substrate) == 0)
    return conceg_ctx_fail(
        ctx, CONCEG_E_MISSING,
        "query: /meshes: expected at least one surface, got none; run the mesh stage first");
  query = calloc(1, sizeof *query);
  if (!query) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "query: out of memory");
  conceg_substrate_box(substrate, query->box.lo, query->box.hi, query->box.periodic);
  query->surface_count = conceg_substrate_meshes(substrate);
  query->surfaces = calloc(query->surface_count, sizeof *query->surfaces);
  if (!query->surfaces) {
    status = conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "query: out of memory for %llu surfaces",
                             (unsigned long long)query->surface_count);
    conceg_query_free(query);
    return status;
  }
  for (s = 0; s < query->surface_count; s++) {
    conceg_mesh_view view = {0};
    query_surface *surface = &query->surfaces[s];
    view.size = sizeof view;
    status = conceg_substrate_mesh(substrate, s, &view);
    if (status == CONCEG_OK && view.face_count > UINT32_MAX)
      status = conceg_ctx_fail(ctx, CONCEG_E_UNSUPPORTED,
                               "query: /meshes: surface %llu: expected fewer than 2^32 faces",
                               (unsigned long long)s);
    if (status != CONCEG_OK) {
      conceg_query_free(query);
      return status;
    }
    surface->vertex = view.vertex, surface->face = view.face, surface->compartment = view.compartment;
    surface->face_count = view.face_count, surface->first_face = faces, surface->cell = view.cell;
    faces += view.face_count;
  }
  status = query_scene_build(ctx, query);
  if (status == CONCEG_OK) status = query_find_enclosed(ctx, query);
  if (status != CONCEG_OK) {
    conceg_query_free(query);
    return status;
  }
  *out = query;
  return CONCEG_OK;
}

void conceg_query_free(conceg_query *query) {
  if (!query) return;
  if (query->scene) rtcReleaseScene(query->scene);
  if (query->device) rtcReleaseDevice(query->device);
  free(query->images);
  free(query->enclosed);
  free(query->surfaces);
  free(query);
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Points so far away that the nearest image is lost in rounding, or that are no numbers, have no answer. */
static int usable(const conceg_query *query, const double p[3]) {
  int axis;
  for (axis = 0; axis < 3; axis++) {
    const double reach = query->box.periodic[axis] ? 1e9 * conceg_box_side(&query->box, axis) : OPEN_AXIS_UM;
    if (!(fabs(p[axis] - query->centre[axis]) < reach)) return 0;
  }
  return 1;
}

/* A unit vector; false for what is no number. */
static int is_unit(const double d[3]) {
  return fabs(dot(d, d) - 1.0) <= 1e-6;
}

/* 1 when the nearest face alone does not tell: seen too flat, or another cell's face, or one seen from the
 * other side, is as near. */
static int is_tied(const conceg_query *query, const double point[3], const double direction[3],
                   const scene_hit *first, scene_hit next) {
  const double cosine = dot(first->normal, direction);
  if (fabs(cosine) < GRAZING_COSINE) return 1;
  while (next.image != UINT32_MAX && next.distance - first->distance < TIE_UM) {
    const double other = dot(next.normal, direction);
    scene_hit after = next, unused;
    if (query->surfaces[next.surface].cell != query->surfaces[first->surface].cell || other * cosine <= 0.0)
      return 1;
    query_scene_trace(query, point, direction, query->reach, &after, &next, &unused);
  }
  return 0;
}

/* The cell around the point and its face that a ray from the point meets first: seen from behind, the nearest
 * face tells. Seen from the front, the point is outside of that piece of surface, and in a cell only if the
 * piece is. A direction that is not sure is left for the next one; the last one decides in any case. */
static const query_surface *locate_point(const conceg_query *query, const double point[3], uint32_t *face) {
  const query_surface *surface = NULL;
  size_t k;
  int axis, sure = 0;
  for (k = 0; k < DIRECTIONS && !sure; k++) {
    const double length = sqrt(dot(directions[k], directions[k]));
    double direction[3];
    scene_hit hit, second;
    for (axis = 0; axis < 3; axis++)
      direction[axis] = directions[k][axis] / length;
    query_scene_trace(query, point, direction, query->reach, NULL, &hit, &second);
    if (hit.image == UINT32_MAX) return NULL;
    sure = !is_tied(query, point, direction, &hit, second);
    if (dot(hit.normal, direction) <= 0.0) {
      if (query->enclosed && query->enclosed[hit.order])
        sure &= query_enclosing(query, point, direction, UINT64_MAX, &hit);
      else
        hit.image = UINT32_MAX;
    }
    surface = hit.image == UINT32_MAX ? NULL : &query->surfaces[hit.surface];
    *face = hit.face;
  }
  return surface;
}

conceg_status conceg_query_locate(const conceg_query *query, uint64_t count, const double *point,
                                  int64_t *cell, uint8_t *compartment) {
  uint64_t i;
  if (!query || (count && !point)) return CONCEG_E_USAGE;
  for (i = 0; i < count; i++)
    if (!usable(query, point + 3 * i)) return CONCEG_E_RANGE;
  for (i = 0; i < count; i++) {
    uint32_t face = 0;
    const query_surface *surface = locate_point(query, point + 3 * i, &face);
    if (cell) cell[i] = surface ? (int64_t)surface->cell : -1;
    if (compartment) compartment[i] = surface ? surface->compartment[face] : CONCEG_ECS;
  }
  return CONCEG_OK;
}

conceg_status conceg_query_intersect(const conceg_query *query, uint64_t count, const double *origin,
                                     const double *direction, const double *length, conceg_hit *out) {
  uint64_t i;
  if (!query || (count && (!origin || !direction || !length || !out))) return CONCEG_E_USAGE;
  for (i = 0; i < count; i++)
    if (!usable(query, origin + 3 * i) || !is_unit(direction + 3 * i) ||
        !(length[i] >= 0.0 && length[i] <= query->longest))
      return CONCEG_E_RANGE;
  for (i = 0; i < count; i++) {
    const conceg_hit nothing = {INFINITY, {0.0, 0.0, 0.0}, -1, 0, CONCEG_ECS, {0}};
    const query_surface *surface;
    scene_hit first, second;
    query_scene_trace(query, origin + 3 * i, direction + 3 * i, length[i], NULL, &first, &second);
    out[i] = nothing;
    if (first.image == UINT32_MAX) continue;
    surface = &query->surfaces[first.surface];
    out[i].distance = first.distance;
    out[i].normal[0] = first.normal[0], out[i].normal[1] = first.normal[1],
    out[i].normal[2] = first.normal[2];
    out[i].cell = surface->cell;
    out[i].face = first.order;
    out[i].compartment = surface->compartment[first.face];
  }
  return CONCEG_OK;
}
