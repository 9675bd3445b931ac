// SPDX-License-Identifier: BSD-3-Clause
// The exact end of the optimisation: radii are cut until no two bodies overlap and a gap stays, and this is
// checked.
#pragma once

#include "collide.hpp"

#include <cstdint>
#include <vector>

namespace conceg::relax {

struct Cut {
  std::uint64_t pairs = 0;       // pairs looked at
  std::uint64_t sweeps = 0;      // until nothing changed
  std::uint64_t constricted = 0; // points left below 95 % of what they were
  double mean_share = 1;         // of its old radius that a point has, mean over the points
};

// Cuts `radius` (per radius, as in Bodies; somas stay) until every pair keeps `gap`, never below
// bodies.floor; then gives what is free, up to `most`, for which `pairs` must have been found. Points of a
// pair are cut in proportion to what they have above their floor.
Cut cut_radii(const Bodies &bodies, const std::vector<Pair> &pairs, const glm::dvec3 &side, double gap,
              const std::vector<double> &most, std::vector<double> &radius, Workers &workers,
              const Progress &progress);

// The largest single-precision number that is not above x.
float not_above(double x);

// What was found by looking at every pair.
struct Certificate {
  std::uint64_t pairs = 0;       // pairs looked at
  std::uint64_t foreign = 0;     // ... of different cells
  std::uint64_t images = 0;      // ... of a cell and its own periodic image
  std::uint64_t overlapping = 0; // pairs with a gap below 0, whatever their kind
  std::uint64_t tight = 0;       // pairs with a gap of 0 or more but below the one asked for
  double largest_overlap = 0;    // um
  double smallest_gap = 0; // um, over all pairs; negative when some overlap; infinity when there is no pair
  std::uint32_t worst_e = 0, worst_f = 0; // the elements of the smallest gap
  std::uint64_t overlapping_somas = 0;    // pairs of somas with a gap below 0
  double deepest_somas = 0;               // um
  std::uint32_t soma_e = 0, soma_f = 0;   // the cells of the deepest
};

Certificate certify(const Bodies &bodies, const std::vector<Pair> &pairs, const glm::dvec3 &side, double gap,
                    const std::vector<double> &radius, Workers &workers);

// Points at which a neighbour's contact plane leaves less than a tube of `step` um of grid can hold (the
// mesher's condition): distance to the neighbour < gap + 2 * 0.92 step - radius.
std::uint64_t count_pinched(const Bodies &bodies, const std::vector<Pair> &pairs, const glm::dvec3 &side,
                            double gap, double step, const std::vector<double> &radius, Workers &workers);

} // namespace conceg::relax
