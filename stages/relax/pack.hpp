// SPDX-License-Identifier: BSD-3-Clause
// Packing of bodies that may not overlap: they are cut until they do not, widened a little, moved apart,
// again and again, as hard spheres are jammed by swelling them.
#pragma once

#include "part.hpp"
#include "relax.hpp"
#include "separate.hpp"

namespace conceg::relax {

struct Rounds {
  int count = 0;          // 0 = the bodies are only cut
  double widening = 0.12; // um, of every radius at the beginning of the first round, falling to 0.3 of it
  double most = 1;        // of the target radius: no body swells beyond
};

struct Packed {
  std::vector<double> radius;
  Cut cut;       // of the last round
  Parted parted; // before the last cut
};

// Moves `bodies` and gives them radii: every pair keeps strength.gap, or has nothing left to give (as in
// cut_radii). bodies.radius are the targets, before and after.
Packed pack(Bodies &bodies, const Sections &sections, const conceg_box &box, const Strength &strength,
            const Motion &motion, const Rounds &rounds, Collider &collider, Workers &workers,
            const Progress &progress);

} // namespace conceg::relax
