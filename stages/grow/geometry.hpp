// SPDX-License-Identifier: BSD-3-Clause
// Distances between points and segments. A segment is given by its middle and half of its vector. Lengths in
// um.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::grow {

inline double point_segment_distance(const glm::dvec3 &point, const glm::dvec3 &middle,
                                     const glm::dvec3 &half) {
  const glm::dvec3 w = point - middle;
  const double square = glm::dot(half, half);
  const double s = square > 0.0 ? std::clamp(glm::dot(w, half) / square, -1.0, 1.0) : 0.0;
  const glm::dvec3 d = w - s * half;
  return std::sqrt(glm::dot(d, d));
}

// Distance of two segments; `between` = middle of the first minus middle of the second.
inline double segment_segment_distance(const glm::dvec3 &between, const glm::dvec3 &half1,
                                       const glm::dvec3 &half2) {
  const double a = glm::dot(half1, half1), b = glm::dot(half1, half2), c = glm::dot(half2, half2);
  const double d = glm::dot(half1, between), e = glm::dot(half2, between);
  const double determinant = a * c - b * b;
  double s = determinant > 1e-12 * a * c ? std::clamp((b * e - c * d) / determinant, -1.0, 1.0) : 0.0;
  double t = c > 0.0 ? (b * s + e) / c : 0.0;
  if (t < -1.0 || t > 1.0) t = std::clamp(t, -1.0, 1.0);
  s = a > 0.0 ? std::clamp((b * t - d) / a, -1.0, 1.0) : 0.0;
  const glm::dvec3 gap = between + s * half1 - t * half2;
  return std::sqrt(glm::dot(gap, gap));
}

} // namespace conceg::grow
