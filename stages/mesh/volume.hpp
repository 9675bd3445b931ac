// SPDX-License-Identifier: BSD-3-Clause
// The tissue on a regular grid: which cell a voxel's centre lies in, and how far the nearest membrane is.
#pragma once

#include "field.hpp"
#include "vdb.hpp"

namespace conceg::mesh {

constexpr int kLeaf = 8;
constexpr int kLeafVoxels = kLeaf * kLeaf * kLeaf;

// Leaves of 8 x 8 x 8 voxels, x slowest as OpenVDB stores them; leaves far from every cell are left out.
struct Volume {
  glm::dvec3 origin{};  // centre of voxel (0, 0, 0), um
  glm::dvec3 spacing{}; // um
  glm::ivec3 shape{};   // voxels in the box
  double band = 0;      // um; distances are cut to -band .. band
  std::vector<glm::ivec3> leaf_origin;
  std::vector<std::uint32_t> label; // leaf after leaf: cell + 1, 0 = outside all cells
  std::vector<float> distance;      // um, negative inside
};

// `options.h` is the largest spacing. Voxels are those of the box, also where cells leave an open side.
Volume make_volume(const Tissue &tissue, SceneOptions options, Workers &workers, const Progress &progress);

// Borrowed, for write_vdb.
inline LeafVolume leaves(const Volume &volume) {
  return {volume.origin,
          volume.spacing,
          volume.band,
          volume.leaf_origin.size(),
          volume.leaf_origin.empty() ? nullptr : &volume.leaf_origin[0].x,
          volume.label.data(),
          volume.distance.data()};
}

} // namespace conceg::mesh
