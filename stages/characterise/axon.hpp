// SPDX-License-Identifier: BSD-3-Clause
// An axon that was traced in pieces is made one tree.
#pragma once

#include "morphology.hpp"

namespace conceg::characterise {

// The same tree from another end: `end` (a node without children) becomes node 0.
Tree turned_to(const Tree &tree, std::size_t end);

struct Joined {
  std::size_t pieces = 0;
  double bridged_um = 0.0; // cable that was not traced
};

// Joins pieces to `axon`, the one with the smallest gap first: a piece's first sample or one of its tips to
// the nearest sample of what is joined already, while that is no farther than `gap_um`. A piece that is met
// at a tip is turned. `pieces` keeps those that are too far away.
Joined join_pieces(Tree &axon, std::vector<Tree> &pieces, double gap_um);

} // namespace conceg::characterise
