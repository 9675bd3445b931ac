/* SPDX-License-Identifier: BSD-3-Clause */
#include "triangle.h"

#include <math.h>

void query_ray_set(query_ray *ray, const double origin[3], const double direction[3]) {
  int axis, kz = 0;
  for (axis = 0; axis < 3; axis++) {
    ray->origin[axis] = origin[axis];
    ray->direction[axis] = direction[axis];
    if (fabs(direction[axis]) > fabs(direction[kz])) kz = axis;
  }
  ray->kz = kz, ray->kx = (kz + 1) % 3, ray->ky = (kz + 2) % 3;
  ray->sx = direction[ray->kx] / direction[kz];
  ray->sy = direction[ray->ky] / direction[kz];
  ray->sz = 1.0 / direction[kz];
}

static void shear(const query_ray *ray, const double p[3], double *x, double *y, double *z) {
  const double dz = p[ray->kz] - ray->origin[ray->kz];
  *x = (p[ray->kx] - ray->origin[ray->kx]) - ray->sx * dz;
  *y = (p[ray->ky] - ray->origin[ray->ky]) - ray->sy * dz;
  *z = ray->sz * dz;
}

int query_ray_triangle(const query_ray *ray, const double a[3], const double b[3], const double c[3],
                       double *distance) {
  double ax, ay, az, bx, by, bz, cx, cy, cz, u, v, w, sum;
  shear(ray, a, &ax, &ay, &az);
  shear(ray, b, &bx, &by, &bz);
  shear(ray, c, &cx, &cy, &cz);
  u = cx * by - cy * bx;
  v = ax * cy - ay * cx;
  w = bx * ay - by * ax;
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return 0;
  sum = u + v + w;
  if (sum == 0.0) return 0; /* seen edge on: its neighbours decide */
  *distance = (u * az + v * bz + w * cz) / sum;
  return 1;
}

void query_triangle_normal(const double a[3], const double b[3], const double c[3], double normal[3]) {
  const double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  double length;
  normal[0] = e[1] * f[2] - e[2] * f[1];
  normal[1] = e[2] * f[0] - e[0] * f[2];
  normal[2] = e[0] * f[1] - e[1] * f[0];
  length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  if (length > 0.0) normal[0] /= length, normal[1] /= length, normal[2] /= length;
}
