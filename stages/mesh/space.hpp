// SPDX-License-Identifier: BSD-3-Clause
// The extracellular space on the tetrahedra of the common grid: its volume and its pieces, exactly.
#pragma once

#include "field.hpp"

namespace conceg::mesh {

struct Space {
  std::uint64_t pieces = 0;
  double volume = 0;  // share of the box that no cell holds
  double largest = 0; // share of that volume which lies in the largest piece
};

// Fully periodic grids only (E_UNSUPPORTED otherwise): at an open side the space goes on outside the box.
Space extracellular_space(const Scene &scene, const Index &index, Workers &workers, const Progress &progress);

} // namespace conceg::mesh
