// SPDX-License-Identifier: BSD-3-Clause
// Controlled perturbation: what becomes of the cells of a recipe when it loses neurons or gains glia. All
// draws are named by cell id, so that a cell which is not concerned keeps its own.
#pragma once

#include "composition.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::place {

// Factors of the recipe's `perturb`; 1 = as the recipe has it.
struct Perturbation {
  double neurons = 1.0;   // share of the neurons that stay, 0 to 1
  double dendrites = 1.0; // length of each dendritic bar of a neuron, above 0 to 1
  double glia = 1.0;      // number of glial cells
};

bool is_neuron(const std::string &class_name);
bool is_glia(const std::string &class_name);

// 1 for each of `ids` that stays when `share` of them does, rounded to whole cells. Each id has a rank of its
// own, whatever else is there: whoever is lost at a share is lost at every lower one.
std::vector<std::uint8_t> staying(const std::vector<std::uint64_t> &ids, double share, std::uint64_t seed,
                                  const char *stream);

// Demands for what comes on top of `demands` when the cells of the types marked in `grows` are to be `factor`
// (at least 1) times as many, rounded together by the largest remainder. One row per row of `demands`.
std::vector<Demand> additional(const std::vector<Demand> &demands, const std::vector<std::uint8_t> &grows,
                               double factor);

} // namespace conceg::place
