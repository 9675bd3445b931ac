// SPDX-License-Identifier: BSD-3-Clause
// Before anything is marched: where neighbours cut so deep into a neurite that the grid may break it.
#pragma once

#include "field.hpp"

namespace conceg::mesh {

struct Pinch {
  std::uint32_t cell;
  std::uint32_t segments; // where it may break
  double left_um;         // least distance from the axis to the contact plane
  double radius_um;       // there, as the field has it
  glm::dvec3 where;       // um
};

// With the axis of a neurite of radius r at distance m from the nearest other label, the contact plane of
// equation 3 lies (r + m - g) / 2 from the axis. Where that is less than the thinnest tube the cell is
// named. In the order of cells.
std::vector<Pinch> predict_pinches(const Scene &scene, const Index &index, Workers &workers);

} // namespace conceg::mesh
