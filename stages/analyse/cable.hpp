// SPDX-License-Identifier: BSD-3-Clause
// Cable: lengths and mean radii of the neurites.
#pragma once

#include "tissue.hpp"

#include <array>

namespace conceg::analyse {

struct Cable {
  double length = 0;        // um
  double radius_length = 0; // um2, radius integrated along the cable
  double mean_radius() const { return length > 0 ? radius_length / length : 0; }
  void add(const Cable &other) { length += other.length, radius_length += other.radius_length; }
};

// Neurites by SWC code: 2 axon, 3 basal dendrite, 4 apical dendrite, 7 glial process; any other code counts
// in place 0.
constexpr std::array<int, 5> neurite_kinds = {0, 2, 3, 4, 7};
using CellCable = std::array<Cable, neurite_kinds.size()>;

// Per cell. Needs checked skeletons.
std::vector<CellCable> measure_cable(const Skeletons &skeletons);

} // namespace conceg::analyse
