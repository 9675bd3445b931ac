// SPDX-License-Identifier: BSD-3-Clause
// Cross-section of a scene: which cell owns each point of a plane, and where its membranes are.
#pragma once

#include "scene.hpp"

#include <glm/vec2.hpp>

namespace conceg::rendering {

// A plane normal to an axis; across and up are the axes of the picture.
struct CutPlane {
  int axis, across, up;
  double position; // um
};
// x is cut with y across and z up, y with x and z, z with x and y.
CutPlane cut_plane(int axis, double position_um);

// Samples of the plane over the scene's bounds, row 0 at the top.
struct CutMap {
  int width = 0, height = 0;
  std::vector<std::int32_t> body;     // -1 = ECS
  std::vector<std::uint8_t> membrane; // 1 = within the drawn width of a membrane
  double covered = 0.0;               // share of the samples that lie in a cell
};

CutMap cut(const Scene &scene, const CutPlane &plane, int width, int height, double membrane_um,
           Workers &workers, const Progress &progress);

} // namespace conceg::rendering
