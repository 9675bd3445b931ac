// SPDX-License-Identifier: BSD-3-Clause
// Skeletons as overlapping spheres.
#pragma once

#include "chains.hpp"

namespace conceg::relax {

struct Spheres {
  std::vector<std::uint64_t> cell_offset;
  std::vector<glm::dvec3> center;
  std::vector<float> radius;
  std::vector<std::int64_t>
      segment_end; // row of the cell's skeleton that ends the sphere's segment, -1 = soma
};

// Per cell the soma's sphere, then the spheres of each segment from its start to its end. Centres are at most
// `spacing` times the smaller radius of the segment apart. E_RANGE for a spacing that is not above 0.
Spheres resample(const Skeletons &skeletons, double spacing);

} // namespace conceg::relax
