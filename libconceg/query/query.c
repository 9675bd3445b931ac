/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene.h"

#include <math.h>
#include <stdlib.h>

/* A decision closer than this is left to another direction. */
#define TIE_UM 1e-9
#define GRAZING_COSINE 1e-4

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
  *out = NULL;
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
    conceg_query_free(query);
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "query: out of memory for %llu surfaces",
                           (unsigned long long)query->surface_count);
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
  free(query->surfaces);
  free(query);
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static int finite3(const double p[3]) {
  return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

/* Points so far away that the nearest image is lost in rounding, or that are no numbers, have no answer. */
static int usable(const conceg_query *query, const double p[3]) {
  int axis;
  for (axis = 0; axis < 3; axis++) {
    const double reach = query->box.periodic[axis] ? 1e9 * conceg_box_side(&query->box, axis) : 1e12;
    if (!(fabs(p[axis] - query->centre[axis]) < reach)) return 0;
  }
  return 1;
}

/* The nearest face on a ray from the point, seen from behind = inside its cell. A ray that grazes, or that
 * meets a front and a back face within the tie, is dropped for the next direction; the last one decides in
 * any case. */
static const query_surface *locate_point(const conceg_query *query, const double point[3], uint32_t *face) {
  const query_surface *surface = NULL;
  size_t k;
  int axis;
  for (k = 0; k < DIRECTIONS; k++) {
    const double length = sqrt(dot(directions[k], directions[k]));
    double direction[3], cosine;
    scene_hit first, second;
    for (axis = 0; axis < 3; axis++)
      direction[axis] = directions[k][axis] / length;
    query_scene_trace(query, point, direction, query->reach, &first, &second);
    if (first.image == UINT32_MAX) return NULL;
    cosine = dot(first.normal, direction);
    surface = cosine > 0.0 ? &query->surfaces[first.surface] : NULL;
    *face = first.face;
    if (fabs(cosine) < GRAZING_COSINE) continue;
    if (second.image != UINT32_MAX && second.distance - first.distance < TIE_UM &&
        dot(second.normal, direction) * cosine <= 0.0)
      continue;
    break;
  }
  return surface;
}

conceg_status conceg_query_locate(const conceg_query *query, uint64_t count, const double *point,
                                  int64_t *cell, uint8_t *compartment) {
  uint64_t i;
  for (i = 0; i < count; i++) {
    const query_surface *surface;
    uint32_t face = 0;
    if (!usable(query, point + 3 * i)) return CONCEG_E_RANGE;
    surface = locate_point(query, point + 3 * i, &face);
    if (cell) cell[i] = surface ? (int64_t)surface->cell : -1;
    if (compartment)
      compartment[i] = surface && surface->compartment ? surface->compartment[face] : CONCEG_ECS;
  }
  return CONCEG_OK;
}

conceg_status conceg_query_intersect(const conceg_query *query, uint64_t count, const double *origin,
                                     const double *direction, const double *length, conceg_hit *out) {
  uint64_t i;
  for (i = 0; i < count; i++) {
    const conceg_hit nothing = {INFINITY, {0.0, 0.0, 0.0}, -1, 0, CONCEG_ECS, {0}};
    const double *d = direction + 3 * i;
    scene_hit first, second;
    if (!usable(query, origin + 3 * i) || !finite3(d) || !isfinite(length[i]) || length[i] < 0.0 ||
        fabs(dot(d, d) - 1.0) > 1e-6)
      return CONCEG_E_RANGE;
    query_scene_trace(query, origin + 3 * i, d, length[i], &first, &second);
    out[i] = nothing;
    if (first.image == UINT32_MAX) continue;
    out[i].distance = first.distance;
    out[i].normal[0] = first.normal[0], out[i].normal[1] = first.normal[1],
    out[i].normal[2] = first.normal[2];
    out[i].cell = query->surfaces[first.surface].cell;
    out[i].face = first.order;
    if (query->surfaces[first.surface].compartment)
      out[i].compartment = query->surfaces[first.surface].compartment[first.face];
  }
  return CONCEG_OK;
}
