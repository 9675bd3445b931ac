// SPDX-License-Identifier: BSD-3-Clause
// How wide the extracellular space is, from the distances of /volumes at the voxel centres outside of all
// cells.
#pragma once

#include "field.hpp"

namespace conceg::analyse {

struct Pores {
  std::uint64_t voxels = 0;             // outside of all cells; 0: not measured
  double mean = 0, median = 0, p95 = 0; // um to the nearest membrane; distances are cut to `band`
  double beyond = 0;                    // share of those voxels at the band or farther
  // Width of flat clefts with this mean: distances in a cleft are spread evenly between 0 and half its width.
  double cleft_width() const { return 4 * mean; }
};

// `distance` is [leaves][512], um, cut to -band .. band, where `band` is its largest value; voxels of leaves
// that are left out count as the band. Distances are exact at the centres, so voxels wider than a cleft do no
// harm.
Pores pore_sizes(const LabelVolume &volume, const float *distance, Workers &workers);

} // namespace conceg::analyse
