// SPDX-License-Identifier: BSD-3-Clause
// The few places where axes are still too near for even the least radii: they are pushed apart, each by
// itself, while all that is not near them stays. Afterwards cutting radii can always succeed there.
#pragma once

#include "collide.hpp"

#include <cstdint>

namespace conceg::relax {

struct Parted {
  std::uint64_t before = 0, after = 0;          // pairs whose least radii do not keep the gap
  double deepest_before = 0, deepest_after = 0; // um that are missing, of the worst pair
  double largest_move = 0;                      // um, in one turn
};

// Moves points within 3 um of path of such pairs, by at most 0.4 um in each of three turns, so that all pairs
// keep `gap` at the radii bodies.floor; lengths and bends of the segments are kept as far as that allows.
// What is pinned stays. The result does not depend on the number of threads. Errors as of Collider::find.
Parted part(Bodies &bodies, const conceg_box &box, double gap, Collider &collider, Workers &workers);

} // namespace conceg::relax
