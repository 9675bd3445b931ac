// SPDX-License-Identifier: GPL-3.0-or-later
// Circumsphere of a tetrahedron whose corners lie on the lattice of geom.h, from exact integers, so that a
// flat tetrahedron cannot hide its large sphere behind rounding. Lengths in um.
#pragma once

#include "conceg/geom.h"

#include <array>
#include <cstdint>

namespace conceg::triangulate {

struct Sphere {
  std::array<double, 3> center;
  double radius;
};

// False when the corners lie in a plane, or further apart than 4 mm, or off the lattice.
inline bool circumsphere(const std::array<const double *, 4> &corner, Sphere &out) {
  __extension__ typedef __int128 wide;
  std::array<std::array<std::int64_t, 3>, 3> d;
  std::array<wide, 3> square{};
  for (int i = 0; i < 3; i++)
    for (int axis = 0; axis < 3; axis++) {
      const double steps = (corner[i + 1][axis] - corner[0][axis]) / CONCEG_LATTICE_STEP_UM;
      if (!(steps >= -0x1p28 && steps <= 0x1p28)) return false;
      d[i][axis] = static_cast<std::int64_t>(steps);
      if (static_cast<double>(d[i][axis]) != steps) return false;
      square[i] += static_cast<wide>(d[i][axis]) * d[i][axis];
    }
  std::array<wide, 3> numerator{};
  wide determinant = 0;
  for (int i = 0; i < 3; i++) {
    const auto &p = d[(i + 1) % 3], &q = d[(i + 2) % 3];
    for (int axis = 0; axis < 3; axis++) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const wide cross = static_cast<wide>(p[u]) * q[v] - static_cast<wide>(p[v]) * q[u];
      numerator[axis] += square[i] * cross;
      if (i == 0) determinant += cross * d[0][axis];
    }
  }
  if (determinant == 0) return false;
  double r2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    const double offset = 0.5 * CONCEG_LATTICE_STEP_UM *
                          (static_cast<double>(numerator[axis]) / static_cast<double>(determinant));
    out.center[axis] = corner[0][axis] + offset;
    r2 += offset * offset;
  }
  out.radius = __builtin_sqrt(r2);
  return true;
}

} // namespace conceg::triangulate
