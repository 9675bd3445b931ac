// SPDX-License-Identifier: BSD-3-Clause
// Skeletons as runs of points for drawing: thinned until they fit into a number of points. Plain data.
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::reporting {

// The skeletons of a document, borrowed; checked by its reader (offsets ascend, parents come first).
struct SkeletonView {
  const std::uint64_t *cell_offset = nullptr; // [cells + 1]
  const double *position = nullptr;           // [points][3] um, unwrapped
  const float *radius = nullptr;              // [points] um
  const std::int64_t *parent = nullptr;       // [points] row within the cell, -1 = soma
  const std::uint8_t *kind = nullptr;         // [points] SWC code
  std::size_t cells = 0, points = 0;
};

// Unbranched runs. Run i has the points point_offset[i] .. point_offset[i + 1]; one that begins at a fork
// begins with the fork's point.
struct Runs {
  std::vector<glm::dvec3> position; // um
  std::vector<float> radius;        // um
  std::vector<std::uint32_t> point_offset{0}, cell;
  std::vector<std::uint8_t> kind;
};

// The points of every `stride`-th cell, of which within a run those go that are nearer than `spacing_um`
// (along the run) to the one before; ends of runs stay. 0 keeps all.
Runs runs_of(const SkeletonView &skeletons, double spacing_um, std::size_t stride);

// How far skeletons had to be thinned.
struct Thinned {
  Runs runs;
  double spacing_um = 0.0; // 0 = every point
  std::size_t stride = 1;  // every stride-th cell, 1 = all; 0 = none, as even one cell is too much
};

// Every point where they are at most `most`, else a spacing of 0.5, 1, 2, 4 or 8 um, and past that fewer
// cells.
Thinned thin(const SkeletonView &skeletons, std::size_t most);

} // namespace conceg::reporting
