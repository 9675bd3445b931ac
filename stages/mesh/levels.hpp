// SPDX-License-Identifier: BSD-3-Clause
// Levels of detail: coarser versions of finished surfaces, for viewers.
#pragma once

#include "parallel.hpp"
#include "surface_file.hpp"

#include <memory>

namespace conceg::mesh {

constexpr double kLevelStep = 3; // of the tolerance, from one level to the next

struct Level {
  std::unique_ptr<SurfaceFile> file; // what the views look at
  Views surfaces;                    // one per surface of level 0, in its order
  std::size_t unchanged = 0;         // surfaces that could not be made coarser
};

// Level i + 1 is level i simplified with `tolerance` * 3^i um at every vertex. Each surface is closed,
// manifold and outward, of the volume of level 0 within what its tolerance allows; it may cross others and
// itself. A surface for which simplification would break that is taken over from the level before.
std::vector<Level> make_levels(const Views &surfaces, std::size_t cells, int count, double tolerance,
                               const std::string &folder, Workers &workers, const Progress &progress);

} // namespace conceg::mesh
