// SPDX-License-Identifier: BSD-3-Clause
// Surfaces for drawing: vertices merged within voxels until they fit into a number of bytes. Plain data.
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::reporting {

struct Surface {
  std::uint32_t cell = 0;
  std::vector<glm::dvec3> vertex; // um, unwrapped
  std::vector<glm::uvec3> face;
};

// Vertices of a voxel of `step_um` become their mean; faces that have lost a side are left out (Rossignac and
// Borrel 1993). Thin parts may break: for pictures alone.
Surface clustered(const Surface &surface, double step_um);

struct Coarsened {
  std::vector<Surface> surfaces; // none where even the widest step does not fit
  double step_um = 0.0;          // 0 = as they are
};

// Bytes that surfaces take on a page: 6 a vertex, 12 a face.
std::size_t surface_bytes(const std::vector<Surface> &surfaces);

// The surfaces as they are where they fit into `most` bytes, else clustered by 0.1, 0.2, 0.4 or 0.8 um.
Coarsened coarsen(std::vector<Surface> surfaces, std::size_t most);

} // namespace conceg::reporting
