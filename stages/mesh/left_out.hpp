// SPDX-License-Identifier: BSD-3-Clause
// Pieces that the meshes leave out, found again on the skeleton, so that the volumes leave them out too.
#pragma once

#include "components.hpp"
#include "cones.hpp"
#include "parallel.hpp"

namespace conceg::mesh {

// Per skeleton point of the tissue: 1 when the segment that ends there lies outside of its cell's surface,
// with all of nine places across its middle. Cells without left-out pieces are not looked at; empty when no
// cell has any. A root has no segment: 0 on a soma, else as the first segment that begins there.
std::vector<std::uint8_t> left_out_segments(const Tissue &tissue, const Views &surfaces,
                                            const std::vector<Pieces> &pieces, Workers &workers);

// The tissue for the volumes: what is left out are cells of their own behind the others, so that they still
// keep their neighbours where the meshes have them. Which label a cell's voxels get: its number + 1, 0 =
// none.
struct Relabelled {
  Tissue tissue;
  std::vector<std::uint32_t> label; // per cell of `tissue`
};
Relabelled with_left_out_apart(const Tissue &tissue, const std::vector<std::uint8_t> &left_out);

} // namespace conceg::mesh
