// SPDX-License-Identifier: BSD-3-Clause
// Distances between triangles in double precision, for measuring gaps. They decide nothing.
#pragma once

#include <glm/vec3.hpp>

namespace conceg::mesh {

using Corners = glm::dvec3[3];

// Squared distance between two triangles that do not cross.
double triangle_distance2(const Corners &a, const Corners &b);
double point_triangle_distance2(const glm::dvec3 &p, const Corners &t);
// Where they are nearest to each other: a point of each.
struct NearestPoints {
  glm::dvec3 on_a, on_b;
};
NearestPoints nearest_points(const Corners &a, const Corners &b);

} // namespace conceg::mesh
