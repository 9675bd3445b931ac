/* SPDX-License-Identifier: BSD-3-Clause
 * libconceg_query: where is a point, and what does a ray hit, in the periodic meshes of a substrate. Embree
 * finds the candidates, our own double arithmetic decides. After _new every call may be made from any number
 * of threads with one query; answers do not depend on threads or on how a batch is split. A library of its
 * own: link conceg_query. In a build without Embree each call returns E_UNSUPPORTED.
 *
 * Surfaces are taken as the format promises them: closed, outward, disjoint, nested at most. Where two cells
 * overlap, a point is in the one whose face the deciding ray meets first; near a hole the answer depends on
 * that ray. Nothing worse happens. conceg_mesh_view.closed and `conceg validate` tell beforehand. */
#ifndef CONCEG_QUERY_H
#define CONCEG_QUERY_H

#include "conceg/model.h"

CONCEG_BEGIN_C

typedef struct conceg_query conceg_query;

/* Builds the search structure; the substrate is borrowed and must outlive the query. Errors: E_MISSING (no
 * meshes), E_RANGE (a face further than 32767 box sides away, or 1e12 um on an open axis; a box as wide),
 * E_NOMEM (also when faces repeat so often that they pass conceg_ctx_memory), E_UNSUPPORTED (2^32 faces or
 * more; no Embree), E_USAGE (NULL). */
CONCEG_API conceg_status conceg_query_new(conceg_ctx *ctx, const conceg_substrate *substrate,
                                          conceg_query **out) CONCEG_NODISCARD;
CONCEG_API void conceg_query_free(conceg_query *query);

/* For each of `count` points [count][3] (um, any image): the innermost cell, by index, or -1 in the
 * extracellular space; and the compartment code of that cell's face which the deciding ray meets (0 =
 * extracellular): the nearest one along an arbitrary direction, not the nearest of all. Either output may be
 * NULL. A point on a surface is on one side of it, always the same. Errors, before anything is written:
 * E_RANGE for a point that is not finite or further away than 1e9 box sides (1e12 um on an open axis);
 * E_USAGE (NULL). */
CONCEG_API conceg_status conceg_query_locate(const conceg_query *query, uint64_t count, const double *point,
                                             int64_t *cell, uint8_t *compartment) CONCEG_NODISCARD;

typedef struct conceg_hit {
  double distance;  /* um along the unit direction; infinity = nothing within the length asked */
  double normal[3]; /* outward unit normal of the face */
  int64_t cell;     /* -1 = none */
  uint64_t face;    /* index among all faces of the substrate: conceg_mesh_view.first_face + row */
  uint8_t compartment;
  uint8_t reserved[7];
} conceg_hit;

/* First face, of any cell and seen from any side, that each ray meets from `origin` [count][3] along the unit
 * vector `direction` [count][3] within `length` [count] um, over all periodic images; both ends belong to the
 * ray, so a face through the origin is a hit at 0. Of faces at one distance the one with the lowest index. No
 * ray slips between two faces that share an edge. Time grows with the number of box sides a ray crosses.
 *
 * A walker must not sit on a face: rounding puts it on either side. Stop it short of the hit, by a distance
 * that is large against 1e-12 um and small against the step, and look as far beyond the step
 * (spec/simulators.md).
 *
 * Errors, before anything is written: E_RANGE as for locate, for a direction that is no unit vector (1e-6),
 * and for a length that is negative, not finite, above 1e6 sides of the shortest periodic axis or above 1e12
 * um; E_USAGE (NULL).
 */
CONCEG_API conceg_status conceg_query_intersect(const conceg_query *query, uint64_t count,
                                                const double *origin, const double *direction,
                                                const double *length, conceg_hit *out) CONCEG_NODISCARD;

CONCEG_END_C
#endif
