// SPDX-License-Identifier: BSD-3-Clause
// A whole simulation over plain arrays: walkers are seeded, walk, and are looked for where they end.
#pragma once

#include "seeds.hpp"
#include "signals.hpp"

#include <functional>

namespace conceg::simulate {

struct Plan {
  conceg_box box;
  Wanted wanted;
  Timeline timeline;
  Physics physics;
  std::uint64_t walkers = 0, seed = 1;
};

// What has been walked so far; walkers of block i are i * block .. (i + 1) * block.
struct Walked {
  static constexpr std::size_t block = 64;
  std::vector<std::uint8_t> done;   // per block
  std::vector<glm::dvec3> place;    // per walker, local: where it ended
  std::vector<std::uint8_t> inside; // by the membranes that it passed
  Walkers walkers;
  std::vector<Tally> tally; // per block
};

struct Lost {
  std::uint64_t leaks = 0;  // walkers found in another cell, or on another side, than their way says
  std::uint64_t reruns = 0; // how often one of them walked again, with other draws
};

// Called by one thread, now and then and when the run is cancelled, so that what is done can be kept. May be
// empty.
using Keep = std::function<void(const Walked &)>;

// Walks the blocks that are not done.
void walk_all(const Plan &plan, const Walls &walls, const Seeds &seeds, Walked &walked, Workers &workers,
              const Progress &progress, const Keep &keep);

// Looks for every walker by an independent query; those that are not where they should be walk again, up to
// five times.
Lost find_leaks(const Plan &plan, const Walls &walls, const Seeds &seeds, const Locate &locate,
                Walked &walked, Workers &workers, const Progress &progress);

// Whether every edge of these faces has a twin of the other direction: by the sum of a hash over all edges.
bool is_closed(const std::vector<glm::uvec3> &face, std::size_t begin, std::size_t end);

} // namespace conceg::simulate
