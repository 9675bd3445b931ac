// SPDX-License-Identifier: BSD-3-Clause
// Distances between segments and between round cones (balls whose radius runs linearly along a segment), in
// double.
#pragma once

#include <glm/vec3.hpp>

namespace conceg::relax {

struct RoundCone {
  glm::dvec3 a, b;
  double radius_a, radius_b;
};

// Where two bodies come closest: parameters along each axis in [0, 1], and the gap (negative = depth of the
// overlap).
struct Closest {
  double s, t, gap;
};

// Closest points of the two axes; gap = distance of the axes less the interpolated radii there.
Closest closest_axes(const RoundCone &first, const RoundCone &second);

// The exact gap: the smallest of |p(s) - q(t)| - r(s) - r(t), which is a convex function of (s, t). Two round
// cones are disjoint if and only if it is positive.
Closest closest_cones(const RoundCone &first, const RoundCone &second);

} // namespace conceg::relax
