// SPDX-License-Identifier: BSD-3-Clause
// The global optimisation: bodies with their target radii are moved until they no longer overlap.
#pragma once

#include "forces.hpp"
#include "shape.hpp"

#include <functional>

namespace conceg::relax {

struct Motion {
  int iterations = 80;
  double momentum = 0.8; // of the heavy ball
  double step = 0.05;    // um, largest move of a point in one iteration
  double skin = 0.6;     // um, slack of the list of pairs
};

struct Moved {
  std::uint64_t rebuilds = 0, prunes = 0, runs = 0; // lists built, lists pruned, runs of the last one
  std::vector<State> states;                        // of each iteration, before its step
  double mean_shift = 0, largest_shift = 0;         // um, between start and end
  double length_before = 0, length_after = 0;       // um of cable
};

// Called with each iteration's state, the bodies as they stood before its step.
using Watch = std::function<void(int iteration, const State &state)>;

// Moves bodies.position; radii stay. Pinned nodes stay where they are; on an open axis no point leaves the
// box.
Moved move_bodies(Bodies &bodies, const Sections &sections, const conceg_box &box, const Strength &strength,
                  const Motion &motion, Collider &collider, Workers &workers, const Progress &progress,
                  const Watch &watch = {});

} // namespace conceg::relax
