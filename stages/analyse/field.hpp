// SPDX-License-Identifier: BSD-3-Clause
// The share of the box inside somas and neurites, from the signed distance of spheres and round cones at
// voxel centres.
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

} // namespace conceg::analyse
