// SPDX-License-Identifier: BSD-3-Clause
// The tissue on a regular grid: which cell a voxel's centre lies in, and how far the nearest membrane is.
#pragma once

#include "field.hpp"
#include "vdb.hpp"

namespace conceg::mesh {

constexpr int kLeaf = 8;
constexpr int kLeafVoxels = kLeaf * kLeaf * kLeaf;
constexpr double kVolumeBand = 2.0; // steps: distances are cut to -band .. band; what the field is exact in

// Leaves of 8 x 8 x 8 voxels, x slowest as OpenVDB's leaf nodes are; leaves far from every cell are left out.
// Laid out first, so that the values are written once, in place, and their size is known before that.
struct VolumeLayout {
  Scene scene; // nodes at the centres of the voxels
  Index index;
  double band = 0;                  // um
  std::vector<std::uint32_t> label; // per cell of the scene: of its voxels, 0 = none; empty: cell + 1
  std::vector<glm::ivec3> leaf_origin;
  std::vector<std::uint64_t> first_leaf;                         // per block of the index, and one more
  const glm::dvec3 &origin() const { return scene.grid.origin; } // centre of voxel (0, 0, 0), um
  const glm::dvec3 &spacing() const { return scene.grid.step; }  // um
  const glm::ivec3 &shape() const { return scene.grid.size; }    // voxels in the box
  std::size_t values() const { return leaf_origin.size() * kLeafVoxels; }
};

// `options.h` is the largest spacing. Voxels are those of the box, also where cells leave an open side. Cells
// whose `label` is 0 keep the others away, and are in neither labels nor distances.
VolumeLayout lay_out_volume(const Tissue &tissue, SceneOptions options, Workers &workers,
                            const Progress &progress, std::vector<std::uint32_t> label = {});

// label: as above, 0 outside of all cells, or NULL; distance in um, negative inside. values() elements
// each.
void fill_volume(const VolumeLayout &layout, std::uint32_t *label, float *distance, Workers &workers,
                 const Progress &progress);

// Borrowed, for write_vdb.
inline LeafVolume leaves(const VolumeLayout &layout, const std::uint32_t *label, const float *distance) {
  return {layout.origin(),
          layout.spacing(),
          layout.band,
          layout.leaf_origin.size(),
          layout.leaf_origin.empty() ? nullptr : &layout.leaf_origin[0].x,
          label,
          distance};
}

} // namespace conceg::mesh
