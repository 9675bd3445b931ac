/* SPDX-License-Identifier: BSD-3-Clause
 * The double-precision ray-triangle test that decides every query. Watertight (Woop, Benthin, Wald 2013): the
 * edge functions of two triangles that share an edge are exact negatives of each other, so no ray slips
 * between them. */
#ifndef CONCEG_QUERY_TRIANGLE_H
#define CONCEG_QUERY_TRIANGLE_H

typedef struct query_ray {
  double origin[3], direction[3];
  int kx, ky, kz; /* axes permuted so that the direction is largest along kz */
  double sx, sy, sz;
} query_ray;

/* Prepares a ray for the test; the direction must not be 0. */
void query_ray_set(query_ray *ray, const double origin[3], const double direction[3]);

/* 1 if the line of the ray meets the closed triangle: *distance along the direction (may be negative). */
int query_ray_triangle(const query_ray *ray, const double a[3], const double b[3], const double c[3],
                       double *distance);

/* Unit normal of (a, b, c), right-handed; zero for a degenerate triangle. */
void query_triangle_normal(const double a[3], const double b[3], const double c[3], double normal[3]);

#endif
