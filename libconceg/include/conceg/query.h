/* SPDX-License-Identifier: BSD-3-Clause
 * libconceg_query: where is a point, and what does a ray hit, in the periodic meshes of a substrate. Embree
 * finds the candidates, our own double arithmetic decides. Thread-safe after _new. A library of its own: link
 * conceg_query. */
#ifndef CONCEG_QUERY_H
#define CONCEG_QUERY_H

#include "conceg/model.h"

CONCEG_BEGIN_C

typedef struct conceg_query conceg_query;

/* Builds the search structure; the substrate is borrowed and must outlive the query. E_MISSING when it has no
 * meshes. */
CONCEG_API conceg_status conceg_query_new(conceg_ctx *ctx, const conceg_substrate *substrate,
                                          conceg_query **out) CONCEG_NODISCARD;
CONCEG_API void conceg_query_free(conceg_query *query);

/* For each of `count` points (um, any image): the cell index, or -1 in the extracellular space, and the
 * compartment code of the nearest face on the ray that decided (0 = ECS); either output may be NULL. Any
 * thread. E_RANGE for a point that is not finite or further away than 1e9 box sides (1e12 um on an open
 * axis). */
CONCEG_API conceg_status conceg_query_locate(const conceg_query *query, uint64_t count, const double *point,
                                             int64_t *cell, uint8_t *compartment) CONCEG_NODISCARD;

typedef struct conceg_hit {
  double distance;  /* um along the unit direction; infinity = nothing within the length asked */
  double normal[3]; /* outward unit normal of the face */
  int64_t cell;     /* -1 = none */
  uint64_t face;    /* index among all faces of the substrate */
  uint8_t compartment;
  uint8_t reserved[7];
} conceg_hit;

/* First face hit by each ray from `origin` along the unit vector `direction` within `length` um, over all
 * periodic images. Any thread. E_RANGE as for locate, for a direction that is no unit vector (1e-6), and for
 * a length that is negative or not finite. */
CONCEG_API conceg_status conceg_query_intersect(const conceg_query *query, uint64_t count,
                                                const double *origin, const double *direction,
                                                const double *length, conceg_hit *out) CONCEG_NODISCARD;

CONCEG_END_C
#endif
