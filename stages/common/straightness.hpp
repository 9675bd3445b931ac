// SPDX-License-Identifier: BSD-3-Clause
// Straightness of a branch: end-to-end distance over path length. Donors and synthetic cells are judged by
// this one function.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <vector>

namespace conceg {

// Of a line resampled at `step_um` along its path, in [0, 1]; 1 for a line without length.
inline double straightness(const std::vector<glm::dvec3> &line, double step_um) {
  if (line.size() < 2) return 1.0;
  glm::dvec3 last = line.front();
  double path = 0.0, along = 0.0, next = step_um;
  for (std::size_t i = 1; i < line.size(); i++) {
    const glm::dvec3 edge = line[i] - line[i - 1];
    const double length = glm::length(edge);
    for (; length > 0.0 && next <= along + length; next += step_um) {
      const glm::dvec3 point = line[i - 1] + edge * ((next - along) / length);
      path += glm::length(point - last);
      last = point;
    }
    along += length;
  }
  path += glm::length(line.back() - last);
  return path > 0.0 ? std::min(1.0, glm::length(line.back() - line.front()) / path) : 1.0;
}

} // namespace conceg
