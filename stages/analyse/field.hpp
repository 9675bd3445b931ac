// SPDX-License-Identifier: BSD-3-Clause
// The share of the box inside somas and neurites: from the signed distance of spheres and round cones at
// voxel centres, or from the labels of /volumes.
#pragma once

#include "parallel.hpp"
#include "tissue.hpp"

namespace conceg::analyse {

struct FieldShares {
  std::uint64_t voxels = 0;
  double soma = 0, neurite = 0; // shares of the voxels; inside a soma counts as soma
};

// Voxels of at most `step` um; each periodic image of a cell counts. No grid is held: blocks are worked out
// one by one.
FieldShares field_shares(const Cells &cells, const Skeletons &skeletons, const conceg_box &box, double step,
                         Workers &workers, const Progress &progress);

// /volumes as the document holds it: leaves of 8 x 8 x 8 voxels, x slowest; borrowed.
struct LabelVolume {
  glm::dvec3 origin, spacing; // um; centre of voxel (0, 0, 0)
  std::uint64_t shape[3];     // voxels in the box
  std::size_t leaves;
  const std::int32_t *leaf_origin; // [leaves][3]
  const std::uint32_t *label;      // [leaves][512]: cell + 1, 0 = outside
};

// Throws E_FORMAT with dataset[index] when the leaves or labels do not fit the box or the cells.
void check(const LabelVolume &volume, const Cells &cells, const conceg_box &box);

// Calls visit(x, y, z, label) for the voxels of one leaf that lie in the box.
template <class Visit> void visit_leaf(const LabelVolume &volume, std::size_t leaf, const Visit &visit) {
  for (std::size_t voxel = 0; voxel < 512; voxel++) {
    const auto first = [&](std::size_t a) {
      return static_cast<std::size_t>(volume.leaf_origin[3 * leaf + a]);
    };
    const std::size_t x = first(0) + voxel / 64, y = first(1) + voxel / 8 % 8, z = first(2) + voxel % 8;
    if (x < volume.shape[0] && y < volume.shape[1] && z < volume.shape[2])
      visit(x, y, z, volume.label[leaf * 512 + voxel]);
  }
}

// The same shares from labels: a voxel counts as soma when it lies in the soma sphere of its own cell.
FieldShares label_shares(const LabelVolume &volume, const Cells &cells, const conceg_box &box,
                         Workers &workers);

} // namespace conceg::analyse
