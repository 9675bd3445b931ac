// SPDX-License-Identifier: BSD-3-Clause
// Where the somas stand: random, never overlapping. Lengths in um.
#pragma once

#include "composition.hpp"
#include "conceg/geom.h"
#include "parallel.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::place {

// One soma to place: a sphere with its centre in [z_lo, z_hi).
struct SomaRequest {
  std::uint64_t id; // names its random stream
  double radius;
  double z_lo, z_hi;
  const Profile *profile; // NULL = even along z
};

// Spheres that stand already.
struct Somas {
  std::vector<glm::dvec3> center;
  std::vector<double> radius;
};

// Random sequential placement on the lattice of geom.h, largest somas first so that they find room. Surfaces
// of two somas, and of a soma and its own periodic images, are at least `gap_um` apart; at an open side the
// whole soma is inside. `standing` ones keep their place, and others their distance to them. Throws with the
// counts asked and possible when they do not fit.
std::vector<glm::dvec3> place_somas(const conceg_box &box, const std::vector<SomaRequest> &requests,
                                    double gap_um, std::uint64_t seed, const Progress &progress,
                                    const Somas &standing = {});

} // namespace conceg::place
