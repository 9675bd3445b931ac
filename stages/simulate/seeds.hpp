// SPDX-License-Identifier: BSD-3-Clause
// Where walkers begin: uniform by volume in what was asked for.
#pragma once

#include "parallel.hpp"
#include "wrap.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace conceg::simulate {

// Cell row of each point, -1 = extracellular. Called by several workers at once.
using Locate = std::function<void(const glm::dvec3 *points, std::size_t count, std::int64_t *cell)>;

struct Wanted {
  bool extra = true;               // extracellular space
  std::vector<std::uint8_t> cells; // per row: 1 = this cell's inside
  double margin_um = 0.0;          // at least so far inside the box
};

struct Seeds {
  std::vector<glm::dvec3> position; // um, in the box
  std::vector<std::int64_t> cell;
  std::uint64_t tried = 0; // points drawn; count / tried estimates the volume fraction of what is wanted
};

// E_RANGE when nothing is wanted, the margin leaves no room, or no place was found in `tries_limit` points.
Seeds seed_walkers(const conceg_box &box, const Wanted &wanted, std::uint64_t count, std::uint64_t seed,
                   const Locate &locate, Workers &workers, const Progress &progress);

} // namespace conceg::simulate
