// SPDX-License-Identifier: GPL-3.0-or-later
// The largest radius that a process may have at a node before anything has grown. Lengths in um.
#pragma once

#include "conceg/geom.h"
#include "parallel.hpp"

#include <glm/vec3.hpp>

#include <vector>

namespace conceg::triangulate {

struct Soma {
  glm::dvec3 center;
  double radius; // 0 = the cell has no soma
};

// Distance from each node to the nearest soma surface over all periodic images (negative inside a soma), to
// the nearest open side of the box, and at most `cap_um`.
std::vector<float> allowed_radii(const conceg_box &box, const std::vector<glm::dvec3> &nodes,
                                 const std::vector<Soma> &somas, double cap_um, Workers &workers,
                                 const Progress &progress);

} // namespace conceg::triangulate
