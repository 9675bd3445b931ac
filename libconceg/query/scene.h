/* SPDX-License-Identifier: BSD-3-Clause
 * The search structure: every triangle image that meets the box is one Embree user primitive with bounds
 * rounded outward; the intersect callback runs the double test. Cells leave the box unwrapped, so a triangle
 * is listed at each lift where it meets the box: about one image per triangle, and short rays never meet a
 * long cell's bounds in vain. */
#ifndef CONCEG_QUERY_SCENE_H
#define CONCEG_QUERY_SCENE_H

#include "conceg/geom.h"
#include "conceg/query.h"
#include "triangle.h"

#include <embree3/rtcore.h>

typedef struct query_surface {
  const double *vertex;
  const uint32_t *face;
  const uint8_t *compartment;
  uint64_t face_count, first_face; /* first_face = index of its face 0 among all faces */
  uint32_t cell;
} query_surface;

typedef struct triangle_image {
  uint32_t surface, face;
  int16_t lift[3]; /* box sides added to the vertices */
  uint16_t reserved;
} triangle_image;

struct conceg_query {
  conceg_box box;
  query_surface *surfaces;
  uint64_t surface_count;
  triangle_image *images;
  uint64_t image_count;
  double lo[3],
      hi[3];        /* what is searched: the box on periodic axes, the bounds of all surfaces on open ones */
  double centre[3]; /* Embree sees coordinates relative to it */
  double margin;    /* um by which Embree's bounds are widened: above every rounding of its floats */
  double reach;     /* um: no surface is longer, so a ray of this length from inside a cell leaves the cell */
  double longest;   /* um: rays beyond this are refused, see RAY_SIDES */
  uint8_t *enclosed; /* per face: its piece of surface lies inside another cell; NULL = none does */
  RTCDevice device;
  RTCScene scene;
};

/* A face met by a ray. */
typedef struct scene_hit {
  double distance;
  uint64_t order; /* index among all faces: settles equal distances */
  uint32_t image; /* UINT32_MAX = none */
  uint32_t surface, face;
  double normal[3]; /* outward, unit */
} scene_hit;

/* A ray walks from box to box, so its time grows with the sides it crosses. */
#define RAY_SIDES 1e6
/* Coordinates on an open axis (um): the squares of their differences stay finite, their roundings below 1 nm.
 */
#define OPEN_AXIS_UM 1e12

/* Decisions closer than this, or at a flatter angle, are left to another direction. */
#define TIE_UM 1e-9
#define GRAZING_COSINE 1e-4

/* Fills images and the Embree scene of a query whose box and surfaces are set. */
conceg_status query_scene_build(conceg_ctx *ctx, conceg_query *query);

/* The two nearest hits of the ray within [0, length], over all periodic images; only those behind `after`, in
 * the order of distance and face, when it is not NULL. */
void query_scene_trace(const conceg_query *query, const double origin[3], const double direction[3],
                       double length, const scene_hit *after, scene_hit *first, scene_hit *second);

/* Follows the ray from hit to hit until it leaves a cell that it did not enter: the innermost cell that holds
 * the origin. hit->image is UINT32_MAX when there is none. Hits of the face `own` at the origin are passed
 * over (UINT64_MAX: none). Returns 0 when a hit was too close to another one, or too flat, to be sure. */
int query_enclosing(const conceg_query *query, const double origin[3], const double direction[3],
                    uint64_t own, scene_hit *hit);

/* Fills `enclosed` of a query whose scene is built. */
conceg_status query_find_enclosed(conceg_ctx *ctx, conceg_query *query);

#endif
