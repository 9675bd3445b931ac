/* SPDX-License-Identifier: BSD-3-Clause
 * Geometry that every part must agree on: the periodic box and the fixed-point lattice. Lengths in um. Any
 * thread. */
#ifndef CONCEG_GEOM_H
#define CONCEG_GEOM_H

#include <stdint.h>

/* Coordinates of somas and nodes are multiples of this step, and box sides too, so that x +- side is exact.
 */
#define CONCEG_LATTICE_STEP_UM 0x1p-16

typedef struct conceg_box {
  double lo[3], hi[3];
  uint8_t periodic[3];
} conceg_box;

/* Length of the box along axis 0, 1 or 2, in um. */
static inline double conceg_box_side(const conceg_box *box, int axis) {
  return box->hi[axis] - box->lo[axis];
}

/* Nearest lattice coordinate. */
static inline double conceg_snap(double x) {
  return __builtin_floor(x * 0x1p16 + 0.5) * CONCEG_LATTICE_STEP_UM;
}

/* Number of box sides to subtract so that x lies in [lo, hi); 0 on an open axis. */
static inline int32_t conceg_box_lift(const conceg_box *box, int axis, double x) {
  if (!box->periodic[axis]) return 0;
  return (int32_t)__builtin_floor((x - box->lo[axis]) / conceg_box_side(box, axis));
}

/* The image of x in [lo, hi) (periodic axes only). */
static inline double conceg_box_wrap(const conceg_box *box, int axis, double x) {
  if (!box->periodic[axis]) return x;
  const double side = conceg_box_side(box, axis);
  double y = x - side * conceg_box_lift(box, axis, x);
  if (y >= box->hi[axis]) y -= side;
  if (y < box->lo[axis]) y += side;
  return y;
}

/* The image of the difference d = a - b with the smallest size (periodic axes only). */
static inline double conceg_box_nearest(const conceg_box *box, int axis, double d) {
  if (!box->periodic[axis]) return d;
  const double side = conceg_box_side(box, axis);
  return d - side * __builtin_floor(d / side + 0.5);
}

#endif
