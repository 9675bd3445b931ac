// SPDX-License-Identifier: BSD-3-Clause
// The share of the box inside the meshes, by locating random points.
#pragma once

#include "parallel.hpp"
#include "tissue.hpp"

namespace conceg::analyse {

struct PointShare {
  std::uint64_t points = 0;
  std::uint64_t in_several = 0; // points inside more than one cell or image: 0 when the meshes are disjoint
  double inside = 0;            // share of the points
  double standard_error = 0;
};

// Uniform points, each located by the signed faces that a ray from it crosses, over all periodic images.
// Sides are decided in double on edges that neighbouring faces share bit by bit, so that no ray slips between
// two faces.
PointShare locate_points(const Meshes &meshes, const conceg_box &box, std::uint64_t points,
                         std::uint64_t seed, Workers &workers, const Progress &progress);

} // namespace conceg::analyse
