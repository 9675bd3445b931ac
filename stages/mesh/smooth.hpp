// SPDX-License-Identifier: BSD-3-Clause
// One smooth surface of a single cell, free in space: OpenVDB's dual surface of its signed distance, moved
// onto the field and then by what its flat faces leave out (README, equation 6).
#pragma once

#include "check.hpp"
#include "components.hpp"
#include "cones.hpp"

namespace conceg::mesh {

struct SmoothCell {
  Surface surface;
  Pieces pieces;
  CheckResult check;          // of the surface
  int rounds = 0;             // of repair
  std::uint64_t repaired = 0; // places where it met itself on the way
};

// The tissue must have one cell; its surface is relative to `origin` and checked against itself and its own
// images in the tissue's box. Throws E_UNSUPPORTED without OpenVDB and E_STAGE when nothing of the cell is
// left.
SmoothCell smooth_cell(const Tissue &tissue, const SceneOptions &options, const glm::dvec3 &origin,
                       Workers &workers, const Progress &progress);

} // namespace conceg::mesh
