// SPDX-License-Identifier: BSD-3-Clause
// Astrocytes from measured barcodes without positions (README.md): bars get parents, directions and radii
// here.
#pragma once

#include "dictionary.hpp"

#include <functional>

namespace conceg::characterise {

// Persistence diagrams (birth and death, path length in um) and statistics of one kind of process.
struct ProcessStatistics {
  std::vector<std::vector<std::array<double, 2>>> diagrams; // each: {birth, death}
  double trees_mean = 0.0, trees_sd = 0.0;                  // per cell
  double trees_low = 0.0, trees_high = 0.0;
  double trunk_loc = 0.0, trunk_scale = 0.0, trunk_shape = 0.0, trunk_low = 0.0,
         trunk_high = 0.0; // diameter, um
  double sibling_loc = 0.0, sibling_scale = 0.0, sibling_low = 0.0,
         sibling_high = 0.0; // thinner over thicker daughter
  double tip_loc = 0.0, tip_scale = 0.0, tip_shape = 0.0, tip_low = 0.0, tip_high = 0.0;
};

struct AstrocyteStatistics {
  std::vector<ProcessStatistics> processes; // perisynaptic, perivascular
  double soma_radius_mean = 0.0, soma_radius_sd = 0.0;
};

struct AstrocyteRules {
  double shortest_bar_um = 3.0;
  double branch_length_um = 13.0,
         branch_length_sd_um = 6.7;    // wanted: mean over the branches of a tree, and how far off is far
  double order = 2.2, order_sd = 0.77; // same for the branch order
  double territory_radius_um = 27.5;
  double straightness = 0.68, straightness_sd = 0.19;
  double angle_mean = 1.30899693899574718, angle_sd = 0.27925268031909273; // 75 +- 16 degree
};

// Reads the comma-separated numbers (README.md); throws conceg::Error with `name`:line.
AstrocyteStatistics parse_astrocyte(const std::string &text, const std::string &name);

// Mean branch order (1 at the root) of a tree given as bars; rows by birth, parents before children.
double mean_order(const std::vector<BarRow> &rows);

// Keeps the most persistent bars, as many as come nearest to the wanted branch length and order, and infers
// their parents; rows by birth, root first.
std::vector<BarRow> prune_diagram(const std::vector<std::array<double, 2>> &diagram,
                                  const AstrocyteRules &rules);

struct Astrocyte {
  double soma_radius = 0.0;
  std::vector<BarTree> trees;
};
// The `index`-th cell; all draws are keyed by (seed, index).
Astrocyte make_astrocyte(const AstrocyteStatistics &statistics, const AstrocyteRules &rules,
                         std::uint64_t seed, std::uint64_t index);

} // namespace conceg::characterise
