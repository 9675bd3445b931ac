// SPDX-License-Identifier: BSD-3-Clause
// Where a cell may break on the grid, told before anything is meshed: along its skeleton, what the nearest
// other label leaves of it, against what the grid can hold.
#pragma once

#include "field.hpp"

namespace conceg::mesh {

struct Narrow {
  std::uint64_t places = 0; // samples along the skeleton, at most a step apart, with less than kThinnestTube
  double least = 0;         // um: half of the thickness that is left at the narrowest one
  glm::dvec3 where{};       // um, unwrapped
};

// Per cell. A cell without such places comes out in one piece (README, equation 7).
std::vector<Narrow> narrow_places(const Scene &scene, const Index &index, Workers &workers);

} // namespace conceg::mesh
