// SPDX-License-Identifier: BSD-3-Clause
// Distances on a grid of voxels, and from a point to a triangle.
#pragma once

#include "parallel.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::simulate {

struct DistanceGrid {
  int count[3] = {0, 0, 0};
  double edge[3] = {1.0, 1.0, 1.0}; // um
  bool periodic[3] = {true, true, true};
};

// Distance (um) from the centre of each voxel (x fastest) to that of the nearest marked one: the exact
// Euclidean transform of Felzenszwalb and Huttenlocher (2012), periodic where the grid is. Distances are cut
// at `farthest_um`.
std::vector<float> distance_between_centres(const DistanceGrid &grid, const std::vector<std::uint8_t> &marked,
                                            double farthest_um, Workers &workers);

// The point of the triangle abc that is nearest to a point.
glm::dvec3 nearest_point(const glm::dvec3 &point, const glm::dvec3 &a, const glm::dvec3 &b,
                         const glm::dvec3 &c);
// Squared distance (um^2) from a point to the triangle abc.
double squared_distance(const glm::dvec3 &point, const glm::dvec3 &a, const glm::dvec3 &b,
                        const glm::dvec3 &c);

} // namespace conceg::simulate
