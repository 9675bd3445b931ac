/* SPDX-License-Identifier: BSD-3-Clause
 * Inside or outside by winding numbers, in long double: the oracle that locate is held against. */
#ifndef CONCEG_QUERY_TESTS_WINDING_H
#define CONCEG_QUERY_TESTS_WINDING_H

#include "shapes.h"

/* Solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983), in long double. */
static long double solid_angle(const long double a[3], const long double b[3], const long double c[3]) {
  const long double la = sqrtl(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]),
                    lb = sqrtl(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]),
                    lc = sqrtl(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
  const long double triple = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                             a[2] * (b[0] * c[1] - b[1] * c[0]);
  const long double ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
                    bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2],
                    ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2];
  return 2 * atan2l(triple, la * lb * lc + ab * lc + bc * la + ca * lb);
}

/* Squared distance from the origin to the triangle. */
static long double distance2(const long double a[3], const long double b[3], const long double c[3]) {
  long double best = INFINITY;
  const long double *corner[3] = {a, b, c};
  long double e[3], g[3], n[3], n2 = 0, height = 0;
  int within = 1;
  for (int k = 0; k < 3; k++)
    e[k] = b[k] - a[k], g[k] = c[k] - a[k];
  for (int k = 0; k < 3; k++)
    n[k] = e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3], n2 += n[k] * n[k],
    height += n[k] * a[k];
  for (int i = 0; i < 3; i++) {
    const long double *p = corner[i], *q = corner[(i + 1) % 3];
    long double d[3], pd = 0, d2 = 0, t, sum = 0, side_of = 0;
    for (int k = 0; k < 3; k++)
      d[k] = q[k] - p[k], pd -= p[k] * d[k], d2 += d[k] * d[k];
    t = fminl(1, fmaxl(0, pd / d2));
    for (int k = 0; k < 3; k++) {
      sum += (p[k] + t * d[k]) * (p[k] + t * d[k]);
      side_of -= (d[(k + 1) % 3] * p[(k + 2) % 3] - d[(k + 2) % 3] * p[(k + 1) % 3]) * n[k];
    }
    within &= side_of >= 0;
    best = fminl(best, sum);
  }
  return within ? fminl(best, height * height / n2) : best;
}

/* The winding number of a cell about the point p; *distance: from p to its nearest face. */
static long double winding(const shapes *s, uint32_t cell, const long double p[3], double *distance) {
  double(*vertex)[3] = s->vertex + s->vertex_offset[cell];
  long double sum = 0, least2 = INFINITY;
  for (uint64_t f = s->face_offset[cell]; f < s->face_offset[cell + 1]; f++) {
    long double corner[3][3];
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 3; axis++)
        corner[k][axis] = vertex[s->face[f][k]][axis] - p[axis];
    sum += solid_angle(corner[0], corner[1], corner[2]);
    least2 = fminl(least2, distance2(corner[0], corner[1], corner[2]));
  }
  *distance = (double)sqrtl(least2);
  return sum / (4 * 3.14159265358979323846264338327950288L);
}

#endif
