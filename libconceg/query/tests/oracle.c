/* SPDX-License-Identifier: BSD-3-Clause
 * locate and intersect against a method that shares nothing with them: the winding number of each surface by
 * solid angles in long double, over all periodic images. The cells: one across a corner of the box, one as
 * long as five boxes, two blocks that share a side, a nucleus in a soma, and a cell in another one's cavity.
 */
#define _POSIX_C_SOURCE 200809L
#include "conceg/query.h"

#include "shapes.h"
#include "winding.h"

#include <pthread.h>

static const double side = 24.0;
enum { CORNER, TUBE, LEFT, RIGHT, SOMA, NUCLEUS, SHELL, GUEST, CELLS };

static double uniform(void) {
  static uint64_t counter;
  conceg_rng rng = conceg_rng_stream(5, "oracle", 0);
  rng.counter = counter++;
  return conceg_rng_uniform(&rng);
}

static void make_tissue(shapes *s) {
  const double tube_centre[3] = {2, 17, 11},
               tube[3][3] = {{0.9, 0, 6},
                             {0, 0.8, 11},
                             {0, 0, 57}}, /* long axis oblique, so that no image overlaps */
      left_lo[3] = {4, 4, 4}, left_hi[3] = {7, 7, 7}, right_lo[3] = {7, 4, 4}, right_hi[3] = {10, 7, 7};
  shapes_new(s, side);
  shapes_begin(s, 0.25, 23.5, 0.5, 2.5);
  shapes_sphere(s, 2, 0.25, 23.5, 0.5, 2.5, 0, CONCEG_SOMA);
  shapes_end(s);
  shapes_begin(s, 2, 17, 11, 0);
  shapes_ellipsoid(s, 2, tube_centre, tube, 0, CONCEG_AXON);
  shapes_end(s);
  shapes_begin(s, 5.5, 5.5, 5.5, 1.5);
  shapes_block(s, left_lo, left_hi, CONCEG_BASAL_DENDRITE);
  shapes_end(s);
  shapes_begin(s, 8.5, 5.5, 5.5, 1.5);
  shapes_block(s, right_lo, right_hi, CONCEG_APICAL_DENDRITE);
  shapes_end(s);
  shapes_begin(s, 16, 5, 17, 3);
  shapes_sphere(s, 2, 16, 5, 17, 3, 0, CONCEG_SOMA);
  shapes_end(s);
  shapes_begin(s, 16.5, 5, 17, 1);
  shapes_sphere(s, 2, 16.5, 5, 17, 1.25, 0, CONCEG_NUCLEUS);
  shapes_end(s);
  shapes_begin(s, 16, 5, 5, 3); /* solid between the spheres of 3 and 2 um */
  shapes_sphere(s, 2, 16, 5, 5, 3, 0, CONCEG_MYELIN);
  shapes_sphere(s, 2, 16, 5, 5, 2, 1, CONCEG_MYELIN);
  shapes_end(s);
  shapes_begin(s, 16, 5, 5, 1);
  shapes_sphere(s, 2, 16, 5, 5, 1.25, 0, CONCEG_AXON);
  shapes_end(s);
}

static conceg_query *make_query(conceg_ctx *ctx, const shapes *s, conceg_substrate **substrate) {
  conceg_doc *doc = shapes_doc(ctx, s);
  conceg_query *query = NULL;
  CHECK_EQUAL(conceg_substrate_open(doc, substrate), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  if (*substrate && conceg_query_new(ctx, *substrate, &query) != CONCEG_OK)
    fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  CHECK(query != NULL);
  if (!query) exit(1);
  return query;
}

static void bounds(const shapes *s, uint32_t cell, double lo[3], double hi[3]) {
  for (int axis = 0; axis < 3; axis++)
    lo[axis] = INFINITY, hi[axis] = -INFINITY;
  for (uint64_t v = s->vertex_offset[cell]; v < s->vertex_offset[cell + 1]; v++)
    for (int axis = 0; axis < 3; axis++)
      lo[axis] = fmin(lo[axis], s->vertex[v][axis]), hi[axis] = fmax(hi[axis], s->vertex[v][axis]);
}

/* Bit per cell whose winding number about the point, or any image of it, is 1; *nearest: the distance to the
 * nearest face of the cells whose bounds, widened by 1 nm, hold the point. */
static unsigned inside_of(const shapes *s, const double point[3], double *nearest) {
  *nearest = INFINITY;
  unsigned cells = 0;
  for (uint32_t cell = 0; cell < s->cells; cell++) {
    double lo[3], hi[3];
    int from[3], to[3];
    bounds(s, cell, lo, hi);
    for (int axis = 0; axis < 3; axis++) {
      from[axis] = s->periodic[axis] ? (int)ceil((lo[axis] - 1e-3 - point[axis]) / s->side) : 0;
      to[axis] = s->periodic[axis] ? (int)floor((hi[axis] + 1e-3 - point[axis]) / s->side) : 0;
    }
    for (int x = from[0]; x <= to[0]; x++)
      for (int y = from[1]; y <= to[1]; y++)
        for (int z = from[2]; z <= to[2]; z++) {
          const long double p[3] = {(long double)point[0] + x * (long double)s->side,
                                    (long double)point[1] + y * (long double)s->side,
                                    (long double)point[2] + z * (long double)s->side};
          double distance;
          if (winding(s, cell, p, &distance) > 0.5L) cells |= 1u << cell;
          *nearest = fmin(*nearest, distance);
        }
  }
  return cells;
}

/* The innermost of them: the nucleus rather than its soma. */
static int64_t innermost(unsigned cells) {
  if (cells & 1u << NUCLEUS) return NUCLEUS;
  for (int cell = 0; cell < CELLS; cell++)
    if (cells & 1u << cell) return cell;
  return -1;
}

/* Counts of points: in cells, at least 1e-9 um off every face, and of those the wrong ones. */
struct tally {
  int inside, off, wrong;
};

static void compare(const shapes *s, const conceg_query *query, const double point[3], struct tally *tally) {
  double nearest;
  const int64_t expected = innermost(inside_of(s, point, &nearest));
  int64_t cell = -5;
  uint8_t compartment = 99;
  CHECK_EQUAL(conceg_query_locate(query, 1, point, &cell, &compartment), CONCEG_OK);
  tally->inside += expected >= 0;
  if (nearest < 1e-9) return;
  tally->off++;
  tally->wrong += cell != expected ||
                  compartment != (expected < 0 ? CONCEG_ECS : s->compartment[s->face_offset[expected]]);
}

static void check_random_points(const shapes *s, const conceg_query *query, double spread, int count) {
  struct tally tally = {0};
  for (int i = 0; i < count; i++) {
    const double p[3] = {spread * (uniform() - 0.5) + 12, spread * (uniform() - 0.5) + 12,
                         spread * (uniform() - 0.5) + 12};
    compare(s, query, p, &tally);
  }
  printf("random points in %g um: %d, %d in cells, %d off all faces, %d wrong\n", spread, count, tally.inside,
         tally.off, tally.wrong);
  CHECK_EQUAL(tally.wrong, 0);
  CHECK(tally.inside > count / 60 && tally.off > count - count / 100);
}

/* Points from which the first direction that locate tries meets a vertex or an edge, and points 2 nm to 2 pm
 * off the faces, edges and vertices on either side: the hardest there are. */
static void check_hard_points(const shapes *s, const conceg_query *query, int count) {
  static const double direction[3] = {0.5320, 0.3970, 0.7479};
  struct tally tally = {0};
  for (int i = 0; i < count; i++) {
    const uint32_t cell = (uint32_t)(uniform() * s->cells);
    const uint64_t faces = s->face_offset[cell + 1] - s->face_offset[cell];
    const uint32_t *f = s->face[s->face_offset[cell] + (uint64_t)(uniform() * (double)faces)];
    double(*vertex)[3] = s->vertex + s->vertex_offset[cell];
    const double *a = vertex[f[0]], *b = vertex[f[1]], *c = vertex[f[2]];
    const int aimed = i % 4, off = i / 4 % 2;
    const double u = aimed == 0   ? 0
                     : aimed == 1 ? 0.5
                     : aimed == 2 ? uniform()
                                  : 1.0 / 3,
                 v = aimed == 3 ? 1.0 / 3 : 0;
    const double far = 3 * uniform(), near = (i % 3 ? 1 : -1) * (i % 5 ? 2e-9 : 2e-3);
    double e[3], g[3], n[3], p[3], length = 0;
    for (int k = 0; k < 3; k++)
      e[k] = b[k] - a[k], g[k] = c[k] - a[k];
    for (int k = 0; k < 3; k++)
      n[k] = e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3], length += n[k] * n[k];
    for (int k = 0; k < 3; k++)
      p[k] = a[k] + u * e[k] + v * g[k] + (off ? near * n[k] / sqrt(length) : -far * direction[k]);
    compare(s, query, p, &tally);
  }
  printf("points aimed at vertices, edges and faces: %d, %d in cells, %d off all faces, %d wrong\n", count,
         tally.inside, tally.off, tally.wrong);
  CHECK_EQUAL(tally.wrong, 0);
  CHECK(tally.inside > count / 10 && tally.off > count - count / 4);
}

/* On the surface itself either side is right, but always the same one: in any image, in any batch. */
static void check_on_surface(const shapes *s, const conceg_query *query) {
  enum { MOST = 4000 };
  static double point[MOST][3], image[MOST][3];
  static int64_t cell[MOST], again[MOST];
  static const double lift[4] = {0, 1, -3, 1e6};
  int count = 0, wrong = 0;
  for (uint64_t v = 0; v < s->vertex_offset[s->cells] && count < MOST; v++)
    memcpy(point[count++], s->vertex[v], sizeof *point);
  for (int x = 0; x <= 6; x++) /* all over the blocks' sides, edges and corners */
    for (int y = 0; y <= 6; y++)
      for (int z = 0; z <= 6 && count < MOST; z++)
        point[count][0] = 4 + x, point[count][1] = 4 + 0.5 * y, point[count][2] = 4 + 0.5 * z, count++;
  for (int x = 0; x < 2; x++) /* the sides and corners of the box */
    for (int y = 0; y < 2; y++)
      for (int z = 0; z < 2 && count < MOST; z++)
        point[count][0] = x * side, point[count][1] = y * side, point[count][2] = z * side, count++;
  CHECK_EQUAL(conceg_query_locate(query, (uint64_t)count, point[0], cell, NULL), CONCEG_OK);
  for (int k = 0; k < 4; k++) {
    for (int i = 0; i < count; i++)
      for (int axis = 0; axis < 3; axis++)
        image[i][axis] = point[i][axis] + (axis == k % 3 ? -1 : 1) * lift[k] * side;
    for (int i = 0; i < count; i += 7)
      CHECK_EQUAL(
          conceg_query_locate(query, (uint64_t)(count - i < 7 ? count - i : 7), image[i], again + i, NULL),
          CONCEG_OK);
    for (int i = 0; i < count; i++)
      wrong += again[i] != cell[i] || cell[i] < -1 || cell[i] >= CELLS;
  }
  printf("points on surfaces: %d in 4 images, %d differ\n", count, wrong);
  CHECK_EQUAL(wrong, 0);
  CHECK_EQUAL(cell[count - 1], CORNER); /* the cell across the corner holds all eight */
  CHECK_EQUAL(cell[count - 8], CORNER);
}

static int is_same(const shapes *s, const double origin[3], const double direction[3], double distance,
                   unsigned cells) {
  double p[3], nearest;
  for (int k = 0; k < 3; k++)
    p[k] = origin[k] + distance * direction[k];
  return inside_of(s, p, &nearest) == cells;
}

/* Long rays, followed from hit to hit: each face is met from the side that locate sees, and none is missed,
 * through every cell and image on the way. Half of them are aimed at vertices. */
static void check_rays(const shapes *s, const conceg_query *query, int count) {
  int hits = 0, wrong = 0, goes_through = 0, touched = 0;
  for (int i = 0; i < count; i++) {
    double origin[3], direction[3], length = 0, nearest;
    const double *aim = s->vertex[(uint64_t)(uniform() * (double)s->vertex_offset[s->cells])];
    int64_t now;
    for (int k = 0; k < 3; k++)
      origin[k] = side * uniform(), direction[k] = i % 2 ? aim[k] - origin[k] : uniform() - 0.5,
      length += direction[k] * direction[k];
    for (int k = 0; k < 3; k++)
      direction[k] /= sqrt(length);
    now = innermost(inside_of(s, origin, &nearest));
    for (int step = 0; step < 40; step++) {
      const double whole = 60;
      conceg_hit hit;
      double middle[3];
      int64_t cell = -5;
      CHECK_EQUAL(conceg_query_intersect(query, 1, origin, direction, &whole, &hit), CONCEG_OK);
      if (hit.cell < 0) break;
      hits++;
      for (int k = 0; k < 3; k++)
        middle[k] = origin[k] + 0.5 * hit.distance * direction[k];
      if (hit.distance > 1e-6) {
        CHECK_EQUAL(conceg_query_locate(query, 1, middle, &cell, NULL), CONCEG_OK);
        const unsigned around = inside_of(s, middle, &nearest);
        if (nearest < 1e-9) break;
        wrong += cell != innermost(around) || (step == 0 && cell != now);
        /* From inside a cell its own face is seen from behind, any other one from the front; but where the
         * ray only touches a vertex or an edge it sees faces of both kinds at once. */
        const double cosine =
            hit.normal[0] * direction[0] + hit.normal[1] * direction[1] + hit.normal[2] * direction[2];
        if ((around >> hit.cell & 1) == (cosine > 0))
          goes_through++;
        else if (is_same(s, origin, direction, hit.distance - 1e-5, around) &&
                 is_same(s, origin, direction, hit.distance + 1e-5, around))
          touched++;
        else
          wrong++;
      }
      for (int k = 0; k < 3; k++)
        origin[k] += (hit.distance + 1e-7) * direction[k];
    }
  }
  printf("rays: %d with %d hits, %d touch a surface, %d wrong\n", count, hits, touched, wrong);
  CHECK_EQUAL(wrong, 0);
  CHECK(goes_through > 20 * touched);
  CHECK(hits > 3 * count);
}

/* A face through the origin is hit at 0, from both sides and by a ray of length 0. */
static void check_on_face(const conceg_query *query) {
  const double origin[3] = {4, 5, 6}, away[3] = {-1, 0, 0}, into[3] = {1, 0, 0}, none = 0, one = 1;
  conceg_hit hit;
  CHECK_EQUAL(conceg_query_intersect(query, 1, origin, into, &none, &hit), CONCEG_OK);
  CHECK(hit.distance == 0 && hit.cell == LEFT && hit.normal[0] == -1);
  CHECK_EQUAL(conceg_query_intersect(query, 1, origin, away, &one, &hit), CONCEG_OK);
  CHECK(hit.distance == 0 && hit.cell == LEFT);
  const double before[3] = {3, 5, 6};
  CHECK_EQUAL(conceg_query_intersect(query, 1, before, into, &one, &hit), CONCEG_OK);
  CHECK(hit.distance == 1);
  const double less = 1 - 1e-12;
  CHECK_EQUAL(conceg_query_intersect(query, 1, before, into, &less, &hit), CONCEG_OK);
  CHECK(isinf(hit.distance) && hit.cell == -1);
}

enum { MANY = 200000 };
static double (*many)[3];
struct half {
  const conceg_query *query;
  uint64_t first, count, batch;
  int64_t *cell;
  int failed;
};
static void *locate_half(void *user) {
  struct half *half = user;
  for (uint64_t i = half->first; i < half->first + half->count; i += half->batch) {
    const uint64_t left = half->first + half->count - i;
    half->failed |= conceg_query_locate(half->query, left < half->batch ? left : half->batch, many[i],
                                        half->cell + i, NULL) != CONCEG_OK;
  }
  return NULL;
}

static void check_batches(const conceg_query *query) {
  int64_t *serial = malloc(MANY * sizeof *serial), *parallel = malloc(MANY * sizeof *parallel);
  many = malloc(MANY * sizeof *many);
  for (int i = 0; i < MANY; i++)
    for (int k = 0; k < 3; k++)
      many[i][k] = 3 * side * uniform();
  pthread_t thread[2];
  struct half all = {query, 0, MANY, MANY, serial, 0},
              half[2] = {{query, 0, MANY / 3, 1000, parallel, 0},
                         {query, MANY / 3, MANY - MANY / 3, 777, parallel, 0}};
  locate_half(&all);
  for (int i = 0; i < 2; i++)
    CHECK_EQUAL(pthread_create(&thread[i], NULL, locate_half, &half[i]), 0);
  for (int i = 0; i < 2; i++)
    pthread_join(thread[i], NULL);
  CHECK(!all.failed && !half[0].failed && !half[1].failed);
  CHECK(memcmp(serial, parallel, MANY * sizeof *serial) == 0);
  free(serial);
  free(parallel);
  free(many);
}

/* A batch with one bad row is refused before anything is written. */
static void check_bad_input(conceg_ctx *ctx, const conceg_query *query) {
  const double point[2][3] = {{1, 1, 1}, {1, INFINITY, 1}}, up[2][3] = {{0, 0, 1}, {0, 0, 0}},
               length[2] = {1, 1}, endless = 1e300;
  int64_t cell[2] = {-7, -7};
  conceg_hit hit[2] = {{.cell = -7}, {.cell = -7}};
  CHECK_EQUAL(conceg_query_locate(query, 2, point[0], cell, NULL), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_intersect(query, 2, point[0], up[0], length, hit), CONCEG_E_RANGE);
  CHECK(cell[0] == -7 && hit[0].cell == -7);
  CHECK_EQUAL(conceg_query_intersect(query, 1, point[0], up[1], length, hit), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_intersect(query, 1, point[0], up[0], &endless, hit), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_intersect(query, 1, point[0], up[0], length, NULL), CONCEG_E_USAGE);
  CHECK_EQUAL(conceg_query_intersect(query, 0, NULL, NULL, NULL, NULL), CONCEG_OK);
  CHECK_EQUAL(conceg_query_locate(query, 1, NULL, cell, NULL), CONCEG_E_USAGE);
  CHECK_EQUAL(conceg_query_locate(NULL, 1, point[0], cell, NULL), CONCEG_E_USAGE);
  CHECK_EQUAL(conceg_query_locate(query, 1, point[0], NULL, NULL), CONCEG_OK);
  conceg_query *none = (conceg_query *)(void *)ctx;
  CHECK_EQUAL(conceg_query_new(ctx, NULL, &none), CONCEG_E_USAGE);
  CHECK(none == NULL);
}

/* Two cells that overlap, which the format forbids: the answer is one of them, in the overlap as elsewhere. A
 * hole in a surface: rays pass through it. */
static void check_broken_tissue(conceg_ctx *ctx) {
  shapes s;
  conceg_substrate *substrate = NULL;
  int overlap = 0, wrong = 0;
  shapes_new(&s, side);
  shapes_begin(&s, 10, 10, 10, 3);
  shapes_sphere(&s, 2, 10, 10, 10, 3, 0, CONCEG_SOMA);
  shapes_end(&s);
  shapes_begin(&s, 12, 10, 10, 3);
  shapes_sphere(&s, 2, 12, 10, 10, 3, 0, CONCEG_SOMA);
  shapes_end(&s);
  conceg_query *query = make_query(ctx, &s, &substrate);
  for (int i = 0; i < 4000; i++) {
    const double p[3] = {7 + 8 * uniform(), 7 + 6 * uniform(), 7 + 6 * uniform()};
    double nearest;
    const unsigned cells = inside_of(&s, p, &nearest);
    int64_t cell = -5;
    CHECK_EQUAL(conceg_query_locate(query, 1, p, &cell, NULL), CONCEG_OK);
    overlap += cells == 3;
    if (cells == 3) wrong += cell != 0 && cell != 1;
    if (cells == 0) wrong += cell != -1;
  }
  printf("points where two cells overlap: %d, %d without one of them\n", overlap, wrong);
  CHECK(overlap > 300);
  CHECK_EQUAL(wrong, 0);
  conceg_query_free(query);
  conceg_substrate_free(substrate);
  s.face_offset[2]--; /* the last face of the second cell */
  const uint32_t *gone = s.face[s.face_offset[2]];
  const double origin[3] = {12, 10, 10}, length = 5;
  double direction[3], norm = 0;
  conceg_hit hit;
  for (int k = 0; k < 3; k++) {
    double(*v)[3] = s.vertex + s.vertex_offset[1];
    direction[k] = (v[gone[0]][k] + v[gone[1]][k] + v[gone[2]][k]) / 3 - origin[k],
    norm += direction[k] * direction[k];
  }
  for (int k = 0; k < 3; k++)
    direction[k] /= sqrt(norm);
  query = make_query(ctx, &s, &substrate);
  CHECK_EQUAL(conceg_query_intersect(query, 1, origin, direction, &length, &hit), CONCEG_OK);
  CHECK(hit.cell != 1);
  conceg_query_free(query);
  conceg_substrate_free(substrate);
  shapes_free(&s);
}

/* Faces that would fill the memory with images, or lie beyond all images, are refused at once. */
static void check_huge(conceg_ctx *ctx) {
  static const double reach[2] = {5000 * 24.0, 1e300};
  static const conceg_status expected[2] = {CONCEG_E_NOMEM, CONCEG_E_RANGE};
  for (int i = 0; i < 2; i++) {
    const double lo[3] = {-reach[i], -reach[i], -reach[i]}, hi[3] = {reach[i], reach[i], reach[i]};
    shapes s;
    conceg_substrate *substrate = NULL;
    conceg_query *query = NULL;
    shapes_new(&s, side);
    shapes_begin(&s, 1, 1, 1, 1);
    shapes_block(&s, lo, hi, CONCEG_SOMA);
    shapes_end(&s);
    s.volume[0] = s.area[0] = 1;
    conceg_doc *doc = shapes_doc(ctx, &s);
    CHECK_EQUAL(conceg_substrate_open(doc, &substrate), CONCEG_OK);
    conceg_doc_close(doc);
    CHECK_EQUAL(conceg_query_new(ctx, substrate, &query), expected[i]);
    CHECK(query == NULL && strstr(conceg_ctx_error(ctx), "/meshes") != NULL);
    conceg_substrate_free(substrate);
    shapes_free(&s);
  }
}

/* One open axis: nothing repeats along it, and far points are outside. */
static void check_open_axis(conceg_ctx *ctx) {
  shapes s;
  conceg_substrate *substrate = NULL;
  make_tissue(&s);
  s.periodic[2] = 0;
  conceg_query *query = make_query(ctx, &s, &substrate);
  check_random_points(&s, query, side, 4000);
  const double far[3] = {12, 12, 1e9}, up[3] = {0, 0, 1}, down[3] = {0, 0, -1}, length = 2e9;
  int64_t cell = -5;
  conceg_hit hit;
  CHECK_EQUAL(conceg_query_locate(query, 1, far, &cell, NULL), CONCEG_OK);
  CHECK_EQUAL(cell, -1);
  CHECK_EQUAL(conceg_query_intersect(query, 1, far, up, &length, &hit),
              CONCEG_E_RANGE); /* beyond 1e6 sides */
  const double high[3] = {5.5, 5.5, 1e6}, enough = 1e6;
  CHECK_EQUAL(conceg_query_intersect(query, 1, high, down, &enough, &hit), CONCEG_OK);
  CHECK_EQUAL(hit.cell, LEFT);
  CHECK_NEAR(hit.distance, 1e6 - 7, 1e-9);
  conceg_query_free(query);
  conceg_substrate_free(substrate);
  shapes_free(&s);
}

int main(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_substrate *substrate = NULL;
  shapes s;
  make_tissue(&s);
  conceg_query *query = make_query(ctx, &s, &substrate);
  check_random_points(&s, query, side, 5000);
  check_random_points(&s, query, 2000 * side, 2000);
  check_hard_points(&s, query, 4000);
  check_on_surface(&s, query);
  check_rays(&s, query, 200);
  check_on_face(query);
  check_batches(query);
  check_bad_input(ctx, query);
  conceg_query_free(query);
  conceg_substrate_free(substrate);
  shapes_free(&s);
  check_open_axis(ctx);
  check_broken_tissue(ctx);
  check_huge(ctx);
  conceg_ctx_free(ctx);
  return check_done();
}
