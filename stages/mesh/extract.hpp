// SPDX-License-Identifier: BSD-3-Clause
// Marching tetrahedra on the Freudenthal split of the common grid: one closed surface per cell in unwrapped
// coordinates.
#pragma once

#include "field.hpp"
#include "surface.hpp"

namespace conceg::mesh {

// One surface per cell (empty where nothing of the cell meets the grid), relative to origin[cell]. The order
// of vertices and faces follows the lifted grid, not the blocks, so that it does not depend on where the box
// begins.
std::vector<Surface> extract_surfaces(const Scene &scene, const Index &index,
                                      const std::vector<glm::dvec3> &origin, Workers &workers,
                                      const Progress &progress);

} // namespace conceg::mesh
