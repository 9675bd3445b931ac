// SPDX-License-Identifier: BSD-3-Clause
// The round cone: the hull of two balls, by which a neurite's segment is drawn; a ball when both ends are one
// point.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace conceg::rendering {

struct RoundCone {
  glm::dvec3 a, b;
  double ra, rb;
};

// Signed distance to the surface, negative within (Quilez 2020).
inline double cone_distance(const RoundCone &cone, const glm::dvec3 &p) {
  const glm::dvec3 ba = cone.b - cone.a, pa = p - cone.a;
  const double l2 = glm::dot(ba, ba), rr = cone.ra - cone.rb, a2 = l2 - rr * rr;
  if (!(l2 > 0.0) || a2 <= 0.0) // one ball holds the other
    return cone.ra >= cone.rb ? glm::length(pa) - cone.ra : glm::length(p - cone.b) - cone.rb;
  const double y = glm::dot(pa, ba), z = y - l2;
  const glm::dvec3 off = pa * l2 - ba * y;
  const double x2 = glm::dot(off, off), y2 = y * y * l2, z2 = z * z * l2;
  const double k = (rr > 0.0 ? 1.0 : rr < 0.0 ? -1.0 : 0.0) * rr * rr * x2;
  if ((z > 0.0 ? 1.0 : -1.0) * a2 * z2 > k) return std::sqrt(x2 + z2) / l2 - cone.rb;
  if ((y > 0.0 ? 1.0 : -1.0) * a2 * y2 < k) return std::sqrt(x2 + y2) / l2 - cone.ra;
  return (std::sqrt(x2 * a2 / l2) + y * rr) / l2 - cone.ra;
}

} // namespace conceg::rendering
