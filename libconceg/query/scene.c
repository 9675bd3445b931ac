/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "scene.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define LIFT_LIMIT 32767
/* What an image takes: itself, and its share of Embree's tree while that is built, as measured. */
#define IMAGE_BYTES 160

static float round_down(double x) {
  const float y = (float)x;
  return (double)y > x ? nextafterf(y, -INFINITY) : y;
}
static float round_up(double x) {
  const float y = (float)x;
  return (double)y < x ? nextafterf(y, INFINITY) : y;
}

static void image_corners(const conceg_query *query, const triangle_image *image, double corner[3][3]) {
  const query_surface *surface = &query->surfaces[image->surface];
  const uint32_t *face = surface->face + 3 * (uint64_t)image->face;
  double shift[3];
  int k, axis;
  for (axis = 0; axis < 3; axis++)
    shift[axis] = image->lift[axis] * (query->box.hi[axis] - query->box.lo[axis]);
  for (k = 0; k < 3; k++) {
    const double *vertex = surface->vertex + 3 * (uint64_t)face[k];
    for (axis = 0; axis < 3; axis++)
      corner[k][axis] = vertex[axis] + shift[axis];
  }
}

/* Range of lifts at which the face's bounds meet the widened box; returns the number of images, or -1 beyond
 * the limit. */
static int64_t face_lifts(const conceg_query *query, const query_surface *surface, uint64_t face, int lo[3],
                          int hi[3]) {
  int64_t count = 1;
  int axis, k;
  for (axis = 0; axis < 3; axis++) {
    double low = INFINITY, high = -INFINITY;
    lo[axis] = hi[axis] = 0;
    for (k = 0; k < 3; k++) {
      const double x = surface->vertex[3 * (uint64_t)surface->face[3 * face + k] + axis];
      low = fmin(low, x), high = fmax(high, x);
    }
    if (!query->box.periodic[axis]) {
      if (!(low > -OPEN_AXIS_UM && high < OPEN_AXIS_UM)) return -1;
      continue;
    }
    const double side = conceg_box_side(&query->box, axis);
    const double from = ceil((query->box.lo[axis] - query->margin - high) / side);
    const double to = floor((query->box.hi[axis] + query->margin - low) / side);
    if (!(from >= -LIFT_LIMIT && to <= LIFT_LIMIT)) return -1;
    lo[axis] = (int)from, hi[axis] = (int)to;
    count *= hi[axis] - lo[axis] + 1;
  }
  return count;
}

/* Visits every image of every face: counts them, and stores them when `images` is not NULL. */
static conceg_status list_images(conceg_ctx *ctx, const conceg_query *query, triangle_image *images,
                                 uint64_t *count) {
  uint64_t s, f, total = 0;
  int lo[3], hi[3], x, y, z;
  for (s = 0; s < query->surface_count; s++) {
    const query_surface *surface = &query->surfaces[s];
    for (f = 0; f < surface->face_count; f++) {
      const int64_t more = face_lifts(query, surface, f, lo, hi);
      if (more < 0)
        return conceg_ctx_fail(ctx, CONCEG_E_RANGE,
                               "query: /meshes: expected surfaces within %d box sides, or %g um on an open "
                               "axis, got face %llu of surface "
                               "%llu beyond",
                               LIFT_LIMIT, OPEN_AXIS_UM, (unsigned long long)f, (unsigned long long)s);
      if (!images) {
        total += (uint64_t)more;
        continue;
      }
      for (x = lo[0]; x <= hi[0]; x++)
        for (y = lo[1]; y <= hi[1]; y++)
          for (z = lo[2]; z <= hi[2]; z++) {
            const triangle_image image = {(uint32_t)s, (uint32_t)f, {(int16_t)x, (int16_t)y, (int16_t)z}, 0};
            images[total++] = image;
          }
    }
  }
  *count = total;
  return CONCEG_OK;
}

/* Bounds of all surfaces, the searched region, the margin and the reach. */
static void measure(conceg_query *query) {
  double size = 0.0, reach2 = 0.0, lo[3] = {INFINITY, INFINITY, INFINITY},
         hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  uint64_t s, f;
  int axis, k;
  for (s = 0; s < query->surface_count; s++) {
    const query_surface *surface = &query->surfaces[s];
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY},
           diagonal2 = 0.0;
    for (f = 0; f < surface->face_count; f++)
      for (k = 0; k < 3; k++)
        for (axis = 0; axis < 3; axis++) {
          const double x = surface->vertex[3 * (uint64_t)surface->face[3 * f + k] + axis];
          low[axis] = fmin(low[axis], x), high[axis] = fmax(high[axis], x);
        }
    if (!surface->face_count) continue;
    for (axis = 0; axis < 3; axis++) {
      diagonal2 += (high[axis] - low[axis]) * (high[axis] - low[axis]);
      lo[axis] = fmin(lo[axis], low[axis]), hi[axis] = fmax(hi[axis], high[axis]);
    }
    reach2 = fmax(reach2, diagonal2);
  }
  for (axis = 0; axis < 3; axis++) {
    const int periodic = query->box.periodic[axis] || !(lo[axis] <= hi[axis]);
    query->lo[axis] = periodic ? query->box.lo[axis] : lo[axis];
    query->hi[axis] = periodic ? query->box.hi[axis] : hi[axis];
    query->centre[axis] = 0.5 * (query->lo[axis] + query->hi[axis]);
    size = fmax(size, query->hi[axis] - query->lo[axis]);
  }
  query->margin = 16.0 * FLT_EPSILON * fmax(size, 1.0);
  query->reach = sqrt(reach2) * (1.0 + 1e-9) + query->margin;
  query->longest = OPEN_AXIS_UM;
  for (axis = 0; axis < 3; axis++)
    if (query->box.periodic[axis])
      query->longest = fmin(query->longest, RAY_SIDES * conceg_box_side(&query->box, axis));
}

static void image_bounds(const struct RTCBoundsFunctionArguments *arguments) {
  const conceg_query *query = arguments->geometryUserPtr;
  struct RTCBounds *out = arguments->bounds_o;
  double corner[3][3], low[3], high[3];
  int axis;
  image_corners(query, &query->images[arguments->primID], corner);
  for (axis = 0; axis < 3; axis++) {
    low[axis] =
        fmin(corner[0][axis], fmin(corner[1][axis], corner[2][axis])) - query->centre[axis] - query->margin;
    high[axis] =
        fmax(corner[0][axis], fmax(corner[1][axis], corner[2][axis])) - query->centre[axis] + query->margin;
  }
  out->lower_x = round_down(low[0]), out->lower_y = round_down(low[1]), out->lower_z = round_down(low[2]);
  out->upper_x = round_up(high[0]), out->upper_y = round_up(high[1]), out->upper_z = round_up(high[2]);
}

/* One segment of a ray on its way through Embree; `context` comes first so that callbacks can reach the rest.
 */
typedef struct traversal {
  struct RTCIntersectContext context;
  query_ray ray;
  double from, to;        /* um along the ray: what may be hit */
  double start;           /* um along the ray: where Embree's float ray begins */
  const scene_hit *after; /* hits up to this one are passed over; NULL = none */
  scene_hit *first, *second;
} traversal;

/* Which face the hit belongs to, and its normal: looked up once the nearest ones are known. */
static void complete(const conceg_query *query, scene_hit *hit) {
  double corner[3][3];
  if (hit->image == UINT32_MAX) return;
  image_corners(query, &query->images[hit->image], corner);
  query_triangle_normal(corner[0], corner[1], corner[2], hit->normal);
  hit->surface = query->images[hit->image].surface, hit->face = query->images[hit->image].face;
}

static int nearer(const scene_hit *a, const scene_hit *b) {
  return a->distance < b->distance || (a->distance == b->distance && a->order < b->order);
}

static void image_intersect(const struct RTCIntersectFunctionNArguments *arguments) {
  const conceg_query *query = arguments->geometryUserPtr;
  const triangle_image *image = &query->images[arguments->primID];
  traversal *walk = (traversal *)(void *)arguments->context;
  double corner[3][3], distance;
  scene_hit hit;
  if (!arguments->valid[0]) return;
  image_corners(query, image, corner);
  if (!query_ray_triangle(&walk->ray, corner[0], corner[1], corner[2], &distance)) return;
  if (!(distance >= walk->from && distance <= walk->to)) return;
  hit.distance = distance;
  hit.image = arguments->primID;
  hit.order = query->surfaces[image->surface].first_face + image->face;
  if (walk->after && !nearer(walk->after, &hit)) return;
  if (nearer(&hit, walk->first)) {
    *walk->second = *walk->first;
    *walk->first = hit;
    /* Later candidates behind the hit are dropped, those within the margin are kept so that ties are seen in
     * any order. */
    ((struct RTCRayHit *)(void *)arguments->rayhit)->ray.tfar =
        round_up(distance - walk->start + 2.0 * query->margin);
  } else if (nearer(&hit, walk->second) && hit.order != walk->first->order) {
    *walk->second = hit;
  }
}

static conceg_status make_images(conceg_ctx *ctx, conceg_query *query) {
  const conceg_status status = list_images(ctx, query, NULL, &query->image_count);
  if (status != CONCEG_OK) return status;
  if (query->image_count >= UINT32_MAX)
    return conceg_ctx_fail(ctx, CONCEG_E_UNSUPPORTED,
                           "query: /meshes: expected fewer than 4294967295 triangles in the box, got %llu",
                           (unsigned long long)query->image_count);
  if (query->image_count > conceg_ctx_memory(ctx) / IMAGE_BYTES)
    return conceg_ctx_fail(
        ctx, CONCEG_E_NOMEM,
        "query: /meshes: expected triangles and periodic images that fit into the context's %llu "
        "bytes of memory, got %llu of them",
        (unsigned long long)conceg_ctx_memory(ctx), (unsigned long long)query->image_count);
  query->images = malloc(sizeof *query->images * (query->image_count ? query->image_count : 1));
  if (!query->images)
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "query: out of memory for %llu triangles",
                           (unsigned long long)query->image_count);
  return list_images(ctx, query, query->images, &query->image_count);
}

conceg_status query_scene_build(conceg_ctx *ctx, conceg_query *query) {
  char config[32] = "";
  RTCGeometry geometry;
  enum RTCError error;
  conceg_status status;
  int axis;
  for (axis = 0; axis < 3; axis++)
    if (!(conceg_box_side(&query->box, axis) < OPEN_AXIS_UM))
      return conceg_ctx_fail(ctx, CONCEG_E_RANGE,
                             "query: /domain@hi[%d]: expected a box narrower than %g um, got %g", axis,
                             OPEN_AXIS_UM, conceg_box_side(&query->box, axis));
  measure(query);
  status = make_images(ctx, query);
  if (status != CONCEG_OK) return status;
  /* A number of threads given to Embree limits TBB in the whole process, so it is given only when it is asked
   * for. */
  if ((long)conceg_ctx_threads(ctx) < sysconf(_SC_NPROCESSORS_ONLN))
    snprintf(config, sizeof config, "threads=%u", (unsigned)conceg_ctx_threads(ctx));
  query->device = rtcNewDevice(config);
  if (!query->device)
    return conceg_ctx_fail(ctx, CONCEG_E_UNSUPPORTED, "query: Embree gave no device (error %d)",
                           (int)rtcGetDeviceError(NULL));
  query->scene = rtcNewScene(query->device);
  rtcSetSceneFlags(query->scene, RTC_SCENE_FLAG_ROBUST);
  geometry = rtcNewGeometry(query->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, (unsigned)query->image_count);
  rtcSetGeometryUserData(geometry, query);
  rtcSetGeometryBoundsFunction(geometry, image_bounds, NULL);
  rtcSetGeometryIntersectFunction(geometry, image_intersect);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(query->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(query->scene);
  error = rtcGetDeviceError(query->device);
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "query: out of memory for the search tree of %llu triangles",
                           (unsigned long long)query->image_count);
  if (error != RTC_ERROR_NONE)
    return conceg_ctx_fail(ctx, CONCEG_E_INTERNAL, "query: Embree failed to build the search tree (error %d)",
                           (int)error);
  return CONCEG_OK;
}

/* Part of [from, to] in which the ray lies between the search bounds of the open axes; 0 if there is none. */
static int clip_to_open_axes(const conceg_query *query, const double origin[3], const double direction[3],
                             double *from, double *to) {
  int axis;
  for (axis = 0; axis < 3; axis++) {
    double a, b;
    if (query->box.periodic[axis]) continue;
    a = query->lo[axis] - query->margin - origin[axis], b = query->hi[axis] + query->margin - origin[axis];
    if (direction[axis] == 0.0) {
      if (a > 0.0 || b < 0.0) return 0;
      continue;
    }
    a /= direction[axis], b /= direction[axis];
    *from = fmax(*from, fmin(a, b)), *to = fmin(*to, fmax(a, b));
  }
  return *from <= *to;
}

/* Searches [from, to] of a ray whose points there lie in the box. */
static void trace_segment(const conceg_query *query, traversal *walk, double from, double to) {
  struct RTCRayHit ray;
  double start[3];
  int axis;
  if (!clip_to_open_axes(query, walk->ray.origin, walk->ray.direction, &from, &to)) return;
  walk->start = from;
  for (axis = 0; axis < 3; axis++)
    start[axis] = walk->ray.origin[axis] + from * walk->ray.direction[axis] - query->centre[axis];
  ray.ray.org_x = (float)start[0], ray.ray.org_y = (float)start[1], ray.ray.org_z = (float)start[2];
  ray.ray.dir_x = (float)walk->ray.direction[0], ray.ray.dir_y = (float)walk->ray.direction[1],
  ray.ray.dir_z = (float)walk->ray.direction[2];
  ray.ray.tnear = 0.0f, ray.ray.tfar = round_up(to - from + 2.0 * query->margin);
  ray.ray.time = 0.0f, ray.ray.mask = ~0u, ray.ray.id = 0, ray.ray.flags = 0;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID, ray.hit.primID = RTC_INVALID_GEOMETRY_ID,
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(query->scene, &walk->context, &ray);
}

void query_scene_trace(const conceg_query *query, const double origin[3], const double direction[3],
                       double length, const scene_hit *after, scene_hit *first, scene_hit *second) {
  double wrapped[3], shifted[3], entered = 0.0;
  int64_t crossed[3] = {0, 0, 0};
  traversal walk;
  int axis;
  first->distance = second->distance = INFINITY;
  first->order = second->order = UINT64_MAX;
  first->image = second->image = UINT32_MAX;
  rtcInitIntersectContext(&walk.context);
  walk.after = after, walk.first = first, walk.second = second;
  for (axis = 0; axis < 3; axis++)
    wrapped[axis] = shifted[axis] = conceg_box_wrap(&query->box, axis, origin[axis]);
  for (;;) {
    double left = INFINITY;
    int through = -1;
    for (axis = 0; axis < 3; axis++) {
      const double d = direction[axis];
      double t;
      if (!query->box.periodic[axis] || d == 0.0) continue;
      t = ((d > 0.0 ? query->box.hi[axis] : query->box.lo[axis]) - shifted[axis]) / d;
      if (t < left) left = t, through = axis;
    }
    query_ray_set(&walk.ray, shifted, direction);
    /* Widened by the margin, so that a face lying in a side of the box is found on either side of it. */
    walk.from = fmax(after ? after->distance : 0.0, entered - query->margin),
    walk.to = fmin(length, left + query->margin);
    if (walk.to >= walk.from) trace_segment(query, &walk, walk.from, walk.to);
    if (first->image != UINT32_MAX || through < 0 || left >= length) break;
    crossed[through] += direction[through] > 0.0 ? 1 : -1;
    shifted[through] = wrapped[through] - (double)crossed[through] * conceg_box_side(&query->box, through);
    entered = left;
  }
  complete(query, first);
  complete(query, second);
}
