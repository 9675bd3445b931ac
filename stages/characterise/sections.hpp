// SPDX-License-Identifier: BSD-3-Clause
// Sections (= branches): runs between root, fork and tip, with their order, straightness and angles at forks.
#pragma once

#include "morphology.hpp"
#include "straightness.hpp"

namespace conceg::characterise {

struct Section {
  std::int64_t parent = -1; // section, -1 = root section
  int order = 1;            // 1 at the root section
  std::vector<std::size_t>
      nodes;           // from the fork that it leaves (the first sample for the root section) to its end
  double length = 0.0; // path, um
};

// Parents come before their children.
std::vector<Section> find_sections(const Tree &tree);

// Unit vector from `node` to the first sample of the run through `child` that does not coincide with it; 0
// when there is none.
glm::dvec3 first_segment(const Tree &tree, const Children &children, std::size_t node, std::size_t child);

// Angle between two directions, rad; 0 when one of them is 0.
double angle_between(const glm::dvec3 &a, const glm::dvec3 &b);

// Local angles of the forks with exactly two daughters, in node order.
std::vector<double> fork_angles(const Tree &tree);

} // namespace conceg::characterise
