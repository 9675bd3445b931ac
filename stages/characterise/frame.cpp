// SPDX-License-Identifier: BSD-3-Clause
#include "frame.hpp"

#include <cmath>

namespace conceg::characterise {

glm::dvec3 apical_axis(const Cell &cell) {
  glm::dvec3 sum(0.0);
  for (const Tree &tree : cell.trees) {
    if (tree.neurite != neurite_apical) continue;
    for (std::size_t i = 1; i < tree.size(); i++) {
      const glm::dvec3 &a = tree.position[static_cast<std::size_t>(tree.parent[i])], &b = tree.position[i];
      sum += glm::length(b - a) * (0.5 * (a + b) - cell.soma);
    }
  }
  const double length = glm::length(sum);
  return length > 0.0 ? sum / length : glm::dvec3(0.0);
}

Rotation rotation_to_z(const glm::dvec3 &axis) {
  if (axis.z < -1.0 + 1e-12) return {0.0, 1.0, 0.0, 0.0};
  const double norm = std::sqrt((1.0 + axis.z) * (1.0 + axis.z) + axis.x * axis.x + axis.y * axis.y);
  return {(1.0 + axis.z) / norm, axis.y / norm, -axis.x / norm, 0.0};
}

glm::dvec3 rotate(const Rotation &q, const glm::dvec3 &v) {
  const glm::dvec3 u(q[1], q[2], q[3]);
  const glm::dvec3 t = 2.0 * glm::cross(u, v);
  return v + q[0] * t + glm::cross(u, t);
}

} // namespace conceg::characterise
