// SPDX-License-Identifier: BSD-3-Clause
// Faces of two labels that are too near to each other, or cross, are moved apart by their vertices, and folds
// are opened: what clusters and simplification took from a gap comes back without making a surface again.
#pragma once

#include "check.hpp"
#include "surface_file.hpp"

namespace conceg::mesh {

struct NudgeOptions {
  double least_gap = 0; // um; what pairs are moved apart to
  double farthest = 0;  // um; no vertex goes farther from where it is
};

// New places of vertices, by vertex number, and the faces that have one of them.
struct Nudged {
  std::vector<std::vector<MovedVertex>> vertex; // per surface
  Changed changed;                              // faces alone
  std::size_t count = 0;                        // of vertices
};

// Of all pairs in `defects`, one after the other in that order; where a surface folds or crosses itself its
// vertices go towards the mean of their neighbours. Surfaces that are `fixed` stay where they are. No face
// loses its area, and none but folded ones turns by more than a right angle: where one would, its vertices
// stay.
Nudged nudge(const Views &surfaces, const std::vector<Defect> &defects,
             const std::vector<std::uint8_t> &fixed, const conceg_box &box, const NudgeOptions &options,
             Workers &workers);

} // namespace conceg::mesh
