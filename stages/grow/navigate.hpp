// SPDX-License-Identifier: BSD-3-Clause
// Network navigation: the paper's cost l = l_t + f l_r over the candidate nodes of a tip.
#pragma once

#include "state.hpp"

namespace conceg::grow {

// l_t, eq. (1): 1/2 [|s-c| / (1 + |s-c|)] (1 - cos(c-s, t-s)); the bracket only with length_factor.
double attractor_cost(const glm::dvec3 &s, const glm::dvec3 &c, const glm::dvec3 &t, bool length_factor);
// l_r, eq. (2): max(0, (r_0 - r_c) / r_0).
double radius_cost(double r_0, double r_c);

// Where a projection stands: a place, the node it belongs to, and that node's image.
struct Tip {
  glm::dvec3 position;
  std::uint32_t node;
  std::int16_t lift[3];
};

struct Candidate {
  double cost;
  glm::dvec3 position; // unwrapped
  std::uint32_t node;
  std::int16_t lift[3];
  float allowed; // r_c; +inf beyond the field's reach
};

// Unwrapped place of a node's image.
glm::dvec3 node_place(const Input &input, std::uint32_t node, const std::int16_t lift[3]);

// Viable candidates of a tip, cheapest first (ties: lower node): edges of the network that are not longer
// than the cap, r_c >= r_min, not used by the cell itself, not banned, not inside the cell's own soma.
void find_candidates(const State &state, const Projection &projection, const Tip &tip, double r_0,
                     const glm::dvec3 &target, std::vector<Candidate> &candidates);

// Whether a tip that runs along `heading` (unit) is at its attractor: within 5 um, or just past it (within 15
// um).
bool attractor_reached(const glm::dvec3 &attractor, const glm::dvec3 &tip, const glm::dvec3 &heading);

// Direction (unit) of the last 5 um of a chain; towards the attractor where there is no length yet.
glm::dvec3 chain_heading(const Projection &projection);

} // namespace conceg::grow
