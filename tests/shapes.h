/* SPDX-License-Identifier: BSD-3-Clause
 * Closed surfaces made for tests, and a document with them as the cells of a periodic box. */
#ifndef CONCEG_TESTS_SHAPES_H
#define CONCEG_TESTS_SHAPES_H

#include "check.h"

#include "conceg/conceg.h"

enum { SHAPES_VERTICES = 40000, SHAPES_FACES = 80000, SHAPES_CELLS = 32 };

typedef struct shapes {
  double side; /* of the box, which begins at 0 */
  uint8_t periodic[3];
  double (*vertex)[3];
  uint32_t (*face)[3]; /* local to the cell */
  uint8_t *compartment;
  uint64_t vertex_offset[SHAPES_CELLS + 1], face_offset[SHAPES_CELLS + 1];
  double volume[SHAPES_CELLS], area[SHAPES_CELLS], soma[SHAPES_CELLS][3];
  float soma_radius[SHAPES_CELLS];
  uint32_t cells; /* one surface each */
} shapes;

static inline void shapes_new(shapes *s, double side) {
  memset(s, 0, sizeof *s);
  s->side = side;
  memset(s->periodic, 1, 3);
  s->vertex = malloc(SHAPES_VERTICES * sizeof *s->vertex);
  s->face = malloc(SHAPES_FACES * sizeof *s->face);
  s->compartment = calloc(SHAPES_FACES, 1);
  if (!s->vertex || !s->face || !s->compartment) exit(1);
}
static inline void shapes_free(shapes *s) {
  free(s->vertex);
  free(s->face);
  free(s->compartment);
}

static inline uint32_t shapes_vertex(shapes *s, double x, double y, double z) {
  const uint64_t i = s->vertex_offset[s->cells + 1]++;
  if (i >= SHAPES_VERTICES) exit(1);
  s->vertex[i][0] = x, s->vertex[i][1] = y, s->vertex[i][2] = z;
  return (uint32_t)(i - s->vertex_offset[s->cells]);
}
static inline void shapes_face(shapes *s, uint32_t a, uint32_t b, uint32_t c, uint8_t compartment) {
  const uint64_t i = s->face_offset[s->cells + 1]++;
  if (i >= SHAPES_FACES) exit(1);
  s->face[i][0] = a, s->face[i][1] = b, s->face[i][2] = c;
  s->compartment[i] = compartment;
}

/* A cell: begin, any number of pieces, end. */
static inline void shapes_begin(shapes *s, double x, double y, double z, double soma_radius) {
  s->vertex_offset[s->cells + 1] = s->vertex_offset[s->cells];
  s->face_offset[s->cells + 1] = s->face_offset[s->cells];
  s->soma[s->cells][0] = x, s->soma[s->cells][1] = y, s->soma[s->cells][2] = z;
  s->soma_radius[s->cells] = (float)soma_radius;
}
static inline void shapes_end(shapes *s) {
  const double(*vertex)[3] = (const double(*)[3])s->vertex + s->vertex_offset[s->cells];
  for (uint64_t f = s->face_offset[s->cells]; f < s->face_offset[s->cells + 1]; f++) {
    const double *a = vertex[s->face[f][0]], *b = vertex[s->face[f][1]], *c = vertex[s->face[f][2]];
    double e[3], g[3], n[3], o[3];
    for (int k = 0; k < 3; k++)
      e[k] = b[k] - a[k], g[k] = c[k] - a[k], o[k] = a[k] - vertex[0][k];
    n[0] = e[1] * g[2] - e[2] * g[1], n[1] = e[2] * g[0] - e[0] * g[2], n[2] = e[0] * g[1] - e[1] * g[0];
    s->area[s->cells] += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    s->volume[s->cells] += (o[0] * n[0] + o[1] * n[1] + o[2] * n[2]) / 6.0;
  }
  s->cells++;
}

/* A piece: the unit octahedron divided `level` times, its corners on the unit sphere, mapped by centre + m x;
 * inward turns its faces round (a cavity). */
static inline void shapes_ellipsoid(shapes *s, int level, const double centre[3], const double m[3][3],
                                    int inward, uint8_t compartment) {
  static const double corner[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  static const int start[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const int n = 1 << level;
  const uint64_t first = s->vertex_offset[s->cells + 1];
  for (int f = 0; f < 8; f++) {
    uint32_t row[2][130];
    for (int i = 0; i <= n; i++) {
      for (int j = 0; j <= n - i; j++) {
        double p[3], length = 0, q[3];
        for (int k = 0; k < 3; k++) {
          p[k] =
              i * corner[start[f][1]][k] + j * corner[start[f][2]][k] + (n - i - j) * corner[start[f][0]][k];
          length += p[k] * p[k];
        }
        for (int k = 0; k < 3; k++) {
          q[k] = centre[k];
          for (int l = 0; l < 3; l++)
            q[k] += m[k][l] * p[l] / sqrt(length);
          q[k] = conceg_snap(q[k]);
        }
        /* Triangles of the octahedron share the vertices of their edges: look the point up. */
        uint64_t v = first;
        while (v < s->vertex_offset[s->cells + 1] && memcmp(s->vertex[v], q, sizeof q))
          v++;
        row[i % 2][j] = v < s->vertex_offset[s->cells + 1] ? (uint32_t)(v - s->vertex_offset[s->cells])
                                                           : shapes_vertex(s, q[0], q[1], q[2]);
      }
      for (int j = 0; i && j <= n - i; j++) {
        const uint32_t *below = row[(i + 1) % 2], *here = row[i % 2];
        /* below[j] below[j+1] here[j]; the corner order of start is 0 -> 1 (i) -> 2 (j) */
        const uint32_t t[3] = {below[j], here[j], below[j + 1]},
                       u[3] = {here[j], here[j + 1 <= n - i ? j + 1 : j], below[j + 1]};
        shapes_face(s, t[0], t[inward ? 2 : 1], t[inward ? 1 : 2], compartment);
        if (j < n - i) shapes_face(s, u[0], u[inward ? 2 : 1], u[inward ? 1 : 2], compartment);
      }
    }
  }
}
static inline void shapes_sphere(shapes *s, int level, double x, double y, double z, double radius,
                                 int inward, uint8_t compartment) {
  const double centre[3] = {x, y, z}, m[3][3] = {{radius, 0, 0}, {0, radius, 0}, {0, 0, radius}};
  shapes_ellipsoid(s, level, centre, m, inward, compartment);
}

/* A piece: the axis-parallel block between two corners, two triangles a side. */
static inline void shapes_block(shapes *s, const double lo[3], const double hi[3], uint8_t compartment) {
  static const uint32_t face[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  uint32_t first = 0;
  for (int i = 0; i < 8; i++) {
    const uint32_t v = shapes_vertex(s, i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1], i & 4 ? hi[2] : lo[2]);
    if (!i) first = v;
  }
  for (int f = 0; f < 12; f++)
    shapes_face(s, first + face[f][0], first + face[f][1], first + face[f][2], compartment);
}

static inline void shapes_put(conceg_doc *doc, const char *path, conceg_dtype dtype, uint64_t rows,
                              uint64_t columns, const void *data) {
  const conceg_array array = {.size = sizeof array,
                              .dtype = dtype,
                              .rank = rows ? (columns ? 2u : 1u) : 0u,
                              .shape = {rows, columns},
                              .data = data};
  if (conceg_doc_write(doc, path, &array) != CONCEG_OK) exit(1);
}

/* A document that keeps every rule: the cells alternate between two types. Owned. */
static inline conceg_doc *shapes_doc(conceg_ctx *ctx, const shapes *s) {
  conceg_doc *doc = NULL;
  const double lo[3] = {0, 0, 0}, hi[3] = {s->side, s->side, s->side}, pia[3] = {0, 0, 1},
               step = CONCEG_LATTICE_STEP_UM;
  const char *const name[] = {"star", "tube"}, *const class[] = {"pyramidal", "astrocyte"},
                    *form[SHAPES_CELLS];
  uint64_t id[SHAPES_CELLS];
  uint32_t type[SHAPES_CELLS], cell[SHAPES_CELLS];
  double soma[SHAPES_CELLS][3], zero[SHAPES_CELLS][3] = {{0}}, within = 0;
  uint8_t closed[SHAPES_CELLS];
  const conceg_box box = {
      {0, 0, 0}, {s->side, s->side, s->side}, {s->periodic[0], s->periodic[1], s->periodic[2]}};
  for (uint32_t i = 0; i < s->cells; i++) {
    id[i] = 100 - i, type[i] = i % 2, cell[i] = i, form[i] = "closed", closed[i] = 1;
    within += s->volume[i] / (s->side * s->side * s->side);
    for (int k = 0; k < 3; k++)
      soma[i][k] = conceg_box_wrap(&box, k, s->soma[i][k]);
  }
  if (conceg_doc_new(ctx, &doc) != CONCEG_OK) exit(1);
  shapes_put(doc, "/domain@lo", CONCEG_F64, 3, 0, lo);
  shapes_put(doc, "/domain@hi", CONCEG_F64, 3, 0, hi);
  shapes_put(doc, "/domain@periodic", CONCEG_U8, 3, 0, s->periodic);
  shapes_put(doc, "/domain@pia", CONCEG_F64, 3, 0, pia);
  shapes_put(doc, "/domain@lattice_step", CONCEG_F64, 0, 0, &step);
  shapes_put(doc, "/types/name", CONCEG_TEXT, 2, 0, name);
  shapes_put(doc, "/types/class", CONCEG_TEXT, 2, 0, class);
  shapes_put(doc, "/cells/id", CONCEG_U64, s->cells, 0, id);
  shapes_put(doc, "/cells/type", CONCEG_U32, s->cells, 0, type);
  shapes_put(doc, "/cells/soma", CONCEG_F64, s->cells, 3, soma);
  shapes_put(doc, "/cells/radius", CONCEG_F32, s->cells, 0, s->soma_radius);
  shapes_put(doc, "/meshes/cell", CONCEG_U32, s->cells, 0, cell);
  shapes_put(doc, "/meshes/form", CONCEG_TEXT, s->cells, 0, form);
  shapes_put(doc, "/meshes/closed", CONCEG_U8, s->cells, 0, closed);
  shapes_put(doc, "/meshes/origin", CONCEG_F64, s->cells, 3, zero);
  shapes_put(doc, "/meshes/vertex_offset", CONCEG_U64, s->cells + 1, 0, s->vertex_offset);
  shapes_put(doc, "/meshes/face_offset", CONCEG_U64, s->cells + 1, 0, s->face_offset);
  shapes_put(doc, "/meshes/vertex", CONCEG_F64, s->vertex_offset[s->cells], 3, s->vertex);
  shapes_put(doc, "/meshes/face", CONCEG_U32, s->face_offset[s->cells], 3, s->face);
  shapes_put(doc, "/meshes/compartment", CONCEG_U8, s->face_offset[s->cells], 0, s->compartment);
  shapes_put(doc, "/meshes/volume", CONCEG_F64, s->cells, 0, s->volume);
  shapes_put(doc, "/meshes/area", CONCEG_F64, s->cells, 0, s->area);
  shapes_put(doc, "/meshes@icvf", CONCEG_F64, 0, 0, &within);
  return doc;
}

#endif
