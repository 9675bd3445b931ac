// SPDX-License-Identifier: BSD-3-Clause
// The path-length barcode of a tree with the parent of every bar (elder rule).
#pragma once

#include "morphology.hpp"

namespace conceg::characterise {

struct Bar {
  double birth = 0.0, death = 0.0; // path length from the first sample, um: fork and tip
  std::int64_t parent = -1;        // bar that goes on at the fork; -1 = the root bar
  std::size_t rival = 0;           // first node of that bar beyond the fork; 0 for the root bar
  std::vector<std::size_t> nodes;  // from the fork (the first sample for the root bar) to the tip
};

// Bars = leaves; the sum of their lengths = the cable length; the first one starts at 0; parents come before
// their children. At a fork the child whose farthest tip is farther survives (ties: the first child), every
// other child starts a bar.
std::vector<Bar> find_bars(const Tree &tree);

} // namespace conceg::characterise
