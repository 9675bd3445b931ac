/* SPDX-License-Identifier: BSD-3-Clause
 * The ray-triangle test: known distances, and watertightness along shared edges and vertices. */
#include "triangle.h"

#include "check.h"

static double uniform(unsigned long long *state) {
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*state >> 11) * 0x1p-53;
}

static void known(void) {
  const double a[3] = {0, 0, 2}, b[3] = {1, 0, 2}, c[3] = {0, 1, 2}, origin[3] = {0.25, 0.25, 0},
               up[3] = {0, 0, 1};
  const double outside[3] = {0.75, 0.75, 0};
  double distance = 0, normal[3];
  query_ray ray;
  query_ray_set(&ray, origin, up);
  CHECK(query_ray_triangle(&ray, a, b, c, &distance));
  CHECK_NEAR(distance, 2.0, 1e-15);
  CHECK(query_ray_triangle(&ray, a, c, b, &distance));
  CHECK_NEAR(distance, 2.0, 1e-15);
  query_ray_set(&ray, outside, up);
  CHECK(!query_ray_triangle(&ray, a, b, c, &distance));
  query_triangle_normal(a, b, c, normal);
  CHECK_NEAR(normal[2], 1.0, 1e-15);
  query_ray_set(&ray, origin, normal);
  CHECK(!query_ray_triangle(&ray, a, b, b, &distance));
}

/* A fan of four triangles over a square: rays aimed at its edges and at its centre meet one of them, whatever
 * the rounding. */
static void watertight(void) {
  unsigned long long state = 7;
  int i, missed = 0;
  for (i = 0; i < 20000; i++) {
    double corner[4][3], centre[3], origin[3], direction[3], distance;
    const double s = i % 4 == 0 ? 0.0 : uniform(&state);
    const int edge = (int)(uniform(&state) * 4.0);
    int k, axis, met = 0;
    query_ray ray;
    for (k = 0; k < 4; k++) {
      corner[k][0] = (k == 1 || k == 2) ? 1.0 + uniform(&state) : -1.0 - uniform(&state);
      corner[k][1] = k >= 2 ? 1.0 + uniform(&state) : -1.0 - uniform(&state);
      corner[k][2] = 5.0 + 0.3 * uniform(&state);
    }
    for (axis = 0; axis < 3; axis++) {
      centre[axis] = 0.25 * (corner[0][axis] + corner[1][axis] + corner[2][axis] + corner[3][axis]);
      origin[axis] = 3.0 * uniform(&state) - (axis == 2 ? 3.0 : 1.5);
    }
    for (axis = 0; axis < 3; axis++)
      direction[axis] = centre[axis] + 0.5 * s * (corner[edge][axis] - centre[axis]) - origin[axis];
    query_ray_set(&ray, origin, direction);
    for (k = 0; k < 4; k++)
      met += query_ray_triangle(&ray, centre, corner[k], corner[(k + 1) % 4], &distance);
    missed += met == 0;
  }
  CHECK_EQUAL(missed, 0);
}

int main(void) {
  known();
  watertight();
  return check_done();
}
