/* SPDX-License-Identifier: BSD-3-Clause
 * locate and intersect on icospheres in a periodic box, against the analytic answer and against a brute force
 * over all triangles and images. */
#include "conceg/query.h"
#include "conceg/conceg.h"

#include "check.h"

#include <pthread.h>

#define LEVEL 3
#define FACES 1280 /* of one icosphere: 20 * 4^LEVEL */
#define VERTICES 642
#define SPHERES 3
#define POINTS 3000

static const double box_side = 20.0;
/* The second sphere crosses a corner of the box, the third lies two boxes away. */
static const double centre[SPHERES][3] = {{10, 9, 8}, {0.5, 19.5, 0.25}, {10.0 + 40.0, 15 - 20.0, 15.5}};
static const double radius[SPHERES] = {4.0, 3.0, 2.0};

static double uniform(unsigned long long *state) {
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*state >> 11) * 0x1p-53;
}

static uint32_t midpoint(double (*vertex)[3], uint32_t *count, uint32_t a, uint32_t b) {
  double m[3], length;
  uint32_t i;
  int axis;
  for (axis = 0; axis < 3; axis++)
    m[axis] = vertex[a][axis] + vertex[b][axis];
  length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
  for (axis = 0; axis < 3; axis++)
    m[axis] /= length;
  for (i = 0; i < *count; i++)
    if (fabs(vertex[i][0] - m[0]) + fabs(vertex[i][1] - m[1]) + fabs(vertex[i][2] - m[2]) < 1e-9) return i;
  memcpy(vertex[*count], m, sizeof m);
  return (*count)++;
}

static void icosphere(double (*vertex)[3], uint32_t (*face)[3]) {
  static const int start[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  const double golden = 0.5 * (1.0 + sqrt(5.0)), scale = 1.0 / sqrt(1.0 + golden * golden);
  static uint32_t next[FACES][3];
  uint32_t faces = 20, count = 12, i, level;
  for (i = 0; i < 12; i++) {
    const int axis = (int)(i / 4);
    vertex[i][(axis + 2) % 3] = 0.0;
    vertex[i][axis] = (i % 2 ? 1.0 : -1.0) * scale;
    vertex[i][(axis + 1) % 3] = (i % 4 < 2 ? golden : -golden) * scale;
  }
  for (i = 0; i < 20; i++)
    face[i][0] = (uint32_t)start[i][0], face[i][1] = (uint32_t)start[i][1],
    face[i][2] = (uint32_t)start[i][2];
  for (level = 0; level < LEVEL; level++) {
    for (i = 0; i < faces; i++) {
      const uint32_t a = face[i][0], b = face[i][1], c = face[i][2];
      const uint32_t ab = midpoint(vertex, &count, a, b), bc = midpoint(vertex, &count, b, c),
                     ca = midpoint(vertex, &count, c, a);
      const uint32_t child[4][3] = {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}};
      memcpy(next[4 * i], child, sizeof child);
    }
    faces *= 4;
    memcpy(face, next, faces * sizeof *face);
  }
}

static double vertices[SPHERES * VERTICES][3];
static uint32_t faces[SPHERES * FACES][3];

static void put(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t rows, uint64_t columns,
                const void *data) {
  conceg_array array = {0};
  array.size = sizeof array;
  array.dtype = dtype, array.rank = columns == 1 ? 1 : 2;
  array.shape[0] = rows, array.shape[1] = columns, array.data = data;
  CHECK_EQUAL(conceg_doc_write(doc, path, &array), CONCEG_OK);
}

static void put_tissue(conceg_doc *doc, int meshes, int periodic) {
  const double lo[3] = {0, 0, 0}, hi[3] = {box_side, box_side, box_side}, pia[3] = {0, 0, 1},
               zero[SPHERES][3] = {{0}};
  const uint8_t wraps[3] = {(uint8_t)periodic, (uint8_t)periodic, (uint8_t)periodic};
  const char *const name[1] = {"ball"}, *const class[1] = {"other"};
  const uint64_t id[SPHERES] = {5, 6, 7};
  const uint32_t type[SPHERES] = {0, 0, 0}, cell[SPHERES] = {0, 1, 2};
  const float soma_radius[SPHERES] = {4, 3, 2};
  const double step = 0x1p-16;
  static uint8_t compartment[SPHERES * FACES];
  uint64_t vertex_offset[SPHERES + 1], face_offset[SPHERES + 1];
  conceg_array scalar = {0};
  int s, i;
  put(doc, "/domain@lo", CONCEG_F64, 3, 1, lo);
  put(doc, "/domain@hi", CONCEG_F64, 3, 1, hi);
  put(doc, "/domain@periodic", CONCEG_U8, 3, 1, wraps);
  put(doc, "/domain@pia", CONCEG_F64, 3, 1, pia);
  scalar.size = sizeof scalar, scalar.dtype = CONCEG_F64, scalar.data = &step;
  CHECK_EQUAL(conceg_doc_write(doc, "/domain@lattice_step", &scalar), CONCEG_OK);
  put(doc, "/types/name", CONCEG_TEXT, 1, 1, name);
  put(doc, "/types/class", CONCEG_TEXT, 1, 1, class);
  put(doc, "/cells/id", CONCEG_U64, SPHERES, 1, id);
  put(doc, "/cells/type", CONCEG_U32, SPHERES, 1, type);
  put(doc, "/cells/soma", CONCEG_F64, SPHERES, 3, centre);
  put(doc, "/cells/radius", CONCEG_F32, SPHERES, 1, soma_radius);
  if (!meshes) return;
  for (s = 0; s <= SPHERES; s++)
    vertex_offset[s] = (uint64_t)s * VERTICES, face_offset[s] = (uint64_t)s * FACES;
  for (i = 0; i < SPHERES * FACES; i++)
    compartment[i] = i % 2 ? CONCEG_SOMA : CONCEG_AXON;
  put(doc, "/meshes/cell", CONCEG_U32, SPHERES, 1, cell);
  put(doc, "/meshes/origin", CONCEG_F64, SPHERES, 3, zero);
  put(doc, "/meshes/vertex_offset", CONCEG_U64, SPHERES + 1, 1, vertex_offset);
  put(doc, "/meshes/face_offset", CONCEG_U64, SPHERES + 1, 1, face_offset);
  put(doc, "/meshes/vertex", CONCEG_F64, SPHERES * VERTICES, 3, vertices);
  put(doc, "/meshes/face", CONCEG_U32, SPHERES * FACES, 3, faces);
  put(doc, "/meshes/compartment", CONCEG_U8, SPHERES * FACES, 1, compartment);
}

static conceg_substrate *make_substrate(conceg_ctx *ctx, int meshes, int periodic) {
  conceg_doc *doc = NULL;
  conceg_substrate *substrate = NULL;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  put_tissue(doc, meshes, periodic);
  if (conceg_substrate_open(doc, &substrate) != CONCEG_OK) fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  CHECK(substrate != NULL);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  return substrate;
}

/* Distance from p to the centre of sphere s or of its nearest image. */
static double distance_to(int s, const double p[3], int periodic) {
  double sum = 0.0;
  int axis;
  for (axis = 0; axis < 3; axis++) {
    double d = p[axis] - centre[s][axis];
    if (periodic) d -= box_side * floor(d / box_side + 0.5);
    sum += d * d;
  }
  return sqrt(sum);
}

static void random_points(double (*point)[3], int count, double spread, unsigned long long seed) {
  int i, axis;
  for (i = 0; i < count; i++)
    for (axis = 0; axis < 3; axis++)
      point[i][axis] = (uniform(&seed) - 0.5) * spread + 0.5 * box_side;
}

static double points[POINTS][3];

/* Points near a facet are left out: between the inscribed radius of the icosphere and its vertices. */
static void check_locate(const conceg_query *query, int periodic, double spread) {
  static int64_t cell[POINTS];
  static uint8_t compartment[POINTS];
  int i, s, wrong = 0, inside = 0;
  random_points(points, POINTS, spread, 11);
  CHECK_EQUAL(conceg_query_locate(query, POINTS, points[0], cell, compartment), CONCEG_OK);
  for (i = 0; i < POINTS; i++) {
    int64_t expected = -1;
    int unclear = 0;
    for (s = 0; s < SPHERES; s++) {
      const double d = distance_to(s, points[i], periodic);
      if (d < 0.98 * radius[s]) expected = s;
      unclear |= d >= 0.98 * radius[s] && d <= radius[s];
    }
    if (unclear) continue;
    inside += expected >= 0;
    wrong += cell[i] != expected || (compartment[i] == CONCEG_ECS) != (expected < 0);
  }
  CHECK_EQUAL(wrong, 0);
  CHECK(inside > 5);
}

static double plane_distance(const double o[3], const double d[3], const double *a, const double *b,
                             const double *c) {
  double e[3], f[3], n[3], w[3], q[3], area2, u, v, t;
  int k;
  for (k = 0; k < 3; k++)
    e[k] = b[k] - a[k], f[k] = c[k] - a[k];
  n[0] = e[1] * f[2] - e[2] * f[1], n[1] = e[2] * f[0] - e[0] * f[2], n[2] = e[0] * f[1] - e[1] * f[0];
  t = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
  if (t == 0.0) return INFINITY;
  t = (n[0] * (a[0] - o[0]) + n[1] * (a[1] - o[1]) + n[2] * (a[2] - o[2])) / t;
  for (k = 0; k < 3; k++)
    w[k] = o[k] + t * d[k] - a[k];
  q[0] = w[1] * f[2] - w[2] * f[1], q[1] = w[2] * f[0] - w[0] * f[2], q[2] = w[0] * f[1] - w[1] * f[0];
  area2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  u = (q[0] * n[0] + q[1] * n[1] + q[2] * n[2]) / area2;
  q[0] = e[1] * w[2] - e[2] * w[1], q[1] = e[2] * w[0] - e[0] * w[2], q[2] = e[0] * w[1] - e[1] * w[0];
  v = (q[0] * n[0] + q[1] * n[1] + q[2] * n[2]) / area2;
  return t >= 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 ? t : INFINITY;
}

/* Nearest hit over all triangles and the images at -2 .. 2 boxes (the rays are shorter than that). */
static double brute(const double o[3], const double d[3], int periodic, uint64_t *face) {
  const int reach = periodic ? 4 : 0;
  double nearest = INFINITY;
  int x, y, z, f;
  for (x = -reach; x <= reach; x++)
    for (y = -reach; y <= reach; y++)
      for (z = -reach; z <= reach; z++) {
        const double shifted[3] = {o[0] + x * box_side, o[1] + y * box_side, o[2] + z * box_side};
        int s;
        for (s = 0; s < SPHERES; s++) {
          double w[3], along = 0.0, off = 0.0;
          int k;
          for (k = 0; k < 3; k++)
            w[k] = centre[s][k] - shifted[k], along += w[k] * d[k];
          for (k = 0; k < 3; k++)
            off += (w[k] - along * d[k]) * (w[k] - along * d[k]);
          if (off > radius[s] * radius[s]) continue; /* the line misses the ball */
          for (f = s * FACES; f < (s + 1) * FACES; f++) {
            double(*v)[3] = vertices + s * VERTICES;
            const double t = plane_distance(shifted, d, v[faces[f][0]], v[faces[f][1]], v[faces[f][2]]);
            if (t < nearest) nearest = t, *face = (uint64_t)f;
          }
        }
      }
  return nearest;
}

static void check_intersect(const conceg_query *query, int periodic) {
  enum { RAYS = 1500 };
  static double direction[RAYS][3], length[RAYS];
  static conceg_hit hit[RAYS];
  unsigned long long state = 21;
  int i, axis, found = 0, none = 0, wrong_face = 0;
  double worst = 0.0, outward = 1.0;
  random_points(points, RAYS, (periodic ? 3.0 : 1.4) * box_side, 31);
  for (i = 0; i < RAYS; i++) {
    double norm = 0.0;
    for (axis = 0; axis < 3; axis++)
      direction[i][axis] = uniform(&state) - 0.5, norm += direction[i][axis] * direction[i][axis];
    for (axis = 0; axis < 3; axis++)
      direction[i][axis] /= sqrt(norm);
    if (i % 50 == 0) direction[i][0] = direction[i][1] = 0.0, direction[i][2] = i % 100 ? 1.0 : -1.0;
    length[i] = 35.0 * uniform(&state);
  }
  CHECK_EQUAL(conceg_query_intersect(query, RAYS, points[0], direction[0], length, hit), CONCEG_OK);
  for (i = 0; i < RAYS; i++) {
    uint64_t face = 0;
    const double expected = brute(points[i], direction[i], periodic, &face);
    if (fabs(expected - length[i]) < 1e-9) continue;
    if (expected > length[i]) {
      none++;
      CHECK(isinf(hit[i].distance) && hit[i].cell == -1);
      continue;
    }
    found++;
    worst = fmax(worst, fabs(hit[i].distance - expected));
    wrong_face += hit[i].face != face;
    CHECK_EQUAL(hit[i].cell, face / FACES);
    CHECK_EQUAL(hit[i].compartment, face % 2 ? CONCEG_SOMA : CONCEG_AXON);
    {
      const double *a = vertices[hit[i].cell * VERTICES + faces[hit[i].face][0]], *c = centre[hit[i].cell];
      double along = 0.0;
      for (axis = 0; axis < 3; axis++)
        along += hit[i].normal[axis] * (a[axis] - c[axis]);
      outward = fmin(outward, along);
    }
  }
  printf("intersect: %d hits, %d without, worst difference %g um\n", found, none, worst);
  CHECK(found > 50 && none > 50);
  CHECK(worst < 1e-12);
  CHECK_EQUAL(wrong_face, 0);
  CHECK(outward > 0.0);
}

/* Rays through vertices and edge midpoints of a sphere meet it: no gap between faces. */
static void check_no_gap(const conceg_query *query) {
  int i, missed = 0;
  for (i = 0; i < VERTICES; i++) {
    const double length = 10.0, *v = vertices[i];
    double direction[3], norm = 0.0;
    conceg_hit hit;
    int axis;
    for (axis = 0; axis < 3; axis++)
      direction[axis] = v[axis] - centre[0][axis], norm += direction[axis] * direction[axis];
    for (axis = 0; axis < 3; axis++)
      direction[axis] /= sqrt(norm);
    CHECK_EQUAL(conceg_query_intersect(query, 1, centre[0], direction, &length, &hit), CONCEG_OK);
    missed += !(fabs(hit.distance - sqrt(norm)) < 1e-9);
  }
  CHECK_EQUAL(missed, 0);
}

typedef struct batch {
  const conceg_query *query;
  int64_t cell[POINTS];
} batch;

static void *locate_all(void *user) {
  batch *work = user;
  if (conceg_query_locate(work->query, POINTS, points[0], work->cell, NULL) != CONCEG_OK) work->cell[0] = -2;
  return NULL;
}

static void check_threads(const conceg_query *query) {
  enum { THREADS = 4 };
  static batch work[THREADS], alone;
  pthread_t thread[THREADS];
  int k;
  random_points(points, POINTS, 4.0 * box_side, 41);
  alone.query = query;
  locate_all(&alone);
  for (k = 0; k < THREADS; k++) {
    work[k].query = query;
    CHECK(pthread_create(&thread[k], NULL, locate_all, &work[k]) == 0);
  }
  for (k = 0; k < THREADS; k++)
    pthread_join(thread[k], NULL);
  for (k = 0; k < THREADS; k++)
    CHECK(memcmp(work[k].cell, alone.cell, sizeof alone.cell) == 0);
}

static void check_bad_input(const conceg_query *query) {
  const double nan_point[3] = {1, NAN, 1}, far_point[3] = {1, 1, 1e300}, point[3] = {1, 1, 1},
               long_direction[3] = {1, 1, 0}, direction[3] = {1, 0, 0};
  const double length = 1.0, negative = -1.0, endless = INFINITY;
  int64_t cell;
  conceg_hit hit;
  CHECK_EQUAL(conceg_query_locate(query, 1, nan_point, &cell, NULL), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_locate(query, 1, far_point, &cell, NULL), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_intersect(query, 1, point, long_direction, &length, &hit), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_intersect(query, 1, point, direction, &negative, &hit), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_intersect(query, 1, point, direction, &endless, &hit), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_query_locate(query, 0, NULL, NULL, NULL), CONCEG_OK);
}

static void check_no_meshes(conceg_ctx *ctx) {
  conceg_substrate *substrate = make_substrate(ctx, 0, 1);
  conceg_query *query = NULL;
  if (!substrate) return;
  CHECK_EQUAL(conceg_query_new(ctx, substrate, &query), CONCEG_E_MISSING);
  CHECK(query == NULL);
  CHECK(strstr(conceg_ctx_error(ctx), "mesh") != NULL);
  conceg_substrate_free(substrate);
}

int main(void) {
  static double unit[VERTICES][3];
  conceg_ctx *ctx = conceg_ctx_new();
  int periodic, s, i, axis;
  conceg_ctx_set_threads(ctx, 2);
  icosphere(unit, faces);
  for (s = 0; s < SPHERES; s++) {
    for (i = 0; i < VERTICES; i++)
      for (axis = 0; axis < 3; axis++)
        vertices[s * VERTICES + i][axis] = centre[s][axis] + radius[s] * unit[i][axis];
    memcpy(faces[s * FACES], faces[0], FACES * sizeof faces[0]);
  }
  for (periodic = 0; periodic < 2; periodic++) {
    conceg_substrate *substrate = make_substrate(ctx, 1, periodic);
    conceg_query *query = NULL;
    if (!substrate) return check_done();
    CHECK_EQUAL(conceg_query_new(ctx, substrate, &query), CONCEG_OK);
    if (!query) return check_done();
    check_locate(query, periodic, box_side);
    check_locate(query, periodic, periodic ? 1000.0 * box_side : 2.0 * box_side);
    check_intersect(query, periodic);
    check_no_gap(query);
    check_threads(query);
    check_bad_input(query);
    conceg_query_free(query);
    conceg_substrate_free(substrate);
  }
  check_no_meshes(ctx);
  conceg_query_free(NULL);
  conceg_ctx_free(ctx);
  return check_done();
}
