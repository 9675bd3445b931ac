// SPDX-License-Identifier: BSD-3-Clause
// Blocks cut out of a tissue at voxels of their own: which of them lie outside of all meshes.
#pragma once

#include "open_voxels.hpp"
#include "tissue.hpp"

namespace conceg::analyse {

struct Block {
  glm::dvec3 lo; // um; may reach over a face of a periodic axis
  double side;   // um
};

// Cubes at uniformly random places: anywhere along periodic axes, within the box along others. E_RANGE when
// the side is longer than one of the box.
std::vector<Block> choose_blocks(const conceg_box &box, std::size_t count, double side, std::uint64_t seed);

// `voxels` along each side. A centre is open when no surface holds it: by the signed faces that a ray along z
// crosses, over all periodic images. No axis of the result is periodic.
OpenVoxels block_voxels(const Meshes &meshes, const conceg_box &box, const Block &block, std::size_t voxels,
                        Workers &workers);

} // namespace conceg::analyse
