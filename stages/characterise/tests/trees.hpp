// SPDX-License-Identifier: BSD-3-Clause
// What the tests of barcodes share: the trees of a file as read, and what must hold for any barcode.
#pragma once

#include "barcode.hpp"

#include "conceg/swc.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace conceg::characterise {

// One tree per root, whatever its types; preorder keeps each of them in one piece.
inline std::vector<Tree> whole_trees(const conceg_swc *swc) {
  std::vector<Tree> trees;
  const double *position = conceg_swc_position(swc);
  std::int64_t first = 0;
  for (std::uint64_t i = 0; i < conceg_swc_count(swc); i++) {
    const std::int64_t up = conceg_swc_parent(swc)[i];
    if (up < 0) {
      first = static_cast<std::int64_t>(i);
      trees.emplace_back();
      trees.back().neurite = conceg_swc_kind(swc)[i];
    }
    trees.back().position.emplace_back(position[3 * i], position[3 * i + 1], position[3 * i + 2]);
    trees.back().radius.push_back(conceg_swc_radius(swc)[i]);
    trees.back().parent.push_back(up < 0 ? -1 : up - first);
  }
  return trees;
}

// Bars = leaves, their lengths add up to the cable, one root bar; one bar starts at 0 (as many as there are
// daughters where the first sample forks); a bar lies inside its parent, children after parents.
inline bool invariants_hold(const Tree &tree, const std::vector<Bar> &bars) {
  const Children children(tree.parent);
  std::size_t leaves = 0, roots = 0, at_zero = 0;
  for (std::size_t i = 0; i < tree.size(); i++)
    leaves += children.count(i) == 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < bars.size(); i++) {
    sum += bars[i].death - bars[i].birth;
    roots += bars[i].parent < 0, at_zero += bars[i].birth == 0.0;
    if (bars[i].parent >= static_cast<std::int64_t>(i)) return false;
    if (bars[i].parent < 0) continue;
    const Bar &up = bars[static_cast<std::size_t>(bars[i].parent)];
    if (up.birth > bars[i].birth || up.death < bars[i].death) return false;
  }
  return bars.size() == leaves && roots == 1 && bars[0].birth == 0.0 &&
         at_zero == std::max<std::size_t>(1, children.count(0)) &&
         std::abs(sum - cable_length(tree)) <= 1e-9 * sum;
}

} // namespace conceg::characterise
