// SPDX-License-Identifier: BSD-3-Clause
// The skeleton of one cell as plain columns, whole or split at the sides of the periodic box.
#pragma once

#include "conceg/geom.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::exporting {

// Points in parent-before-child order; parent -1 = the first point of a tree on its soma, or of a floating
// piece.
struct Tree {
  std::vector<glm::dvec3> position;  // um
  std::vector<double> radius;        // um
  std::vector<double> target_radius; // um; empty when the document has none, like the four columns below
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> kind; // SWC code
  std::vector<double> bar, branch, tree, status;
  std::vector<std::uint8_t> on_soma; // 1 = parent -1 means the soma at its place in the box
  std::size_t size() const { return position.size(); }
};

// Splits every segment where it crosses a periodic side of the box; each piece is moved into the box and
// starts with a point of its own on the side. Radius and target radius are interpolated, the other columns
// are those of the segment's end.
Tree split_at_box(const Tree &whole, const conceg_box &box);

// Maximal runs of points without a fork, as lists of point numbers; a run that leaves a fork starts with the
// fork's point.
std::vector<std::vector<std::uint32_t>> runs(const Tree &tree);

} // namespace conceg::exporting
