// SPDX-License-Identifier: BSD-3-Clause
// Which parts of which cells a block of the tissue needs: sections from their beginnings, joined where they
// are joined in the cell. Plain arrays in and out, lengths in um.
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::block {

// The skeletons of the tissue; rows of cell i are offset[i] .. offset[i + 1].
struct Tissue {
  std::vector<glm::dvec3> soma;
  std::vector<float> soma_radius; // 0 = none
  std::vector<std::uint64_t> offset;
  std::vector<glm::dvec3> position; // unwrapped
  std::vector<float> radius;
  std::vector<std::int64_t> parent;  // row within the cell, -1 = soma
  std::vector<std::uint32_t> branch; // run between forks, numbered in the cell

  std::size_t cells() const { return soma.size(); }
};

// Along z. `side` is the period of the tissue, 0 for an open axis.
struct Slab {
  double lo, hi, margin, side;
};

// A connected part of one image of one cell.
struct Piece {
  std::size_t cell;
  int lift;                        // the image: so many sides further up
  bool has_soma;                   // else it begins at a fork or at a root
  std::vector<std::uint32_t> rows; // within the cell, ascending: parents come before their children
};

// A section belongs to the block when it, or the piece that joins it to its parent, comes as near as the
// margin, surface included; then it is kept from its beginning to its last point near the block or its last
// kept daughter, so that its shape does not depend on where the block ends. Sections that meet in a kept soma
// or fork make one piece; a piece whose parent section is left out begins with the point of the fork. Pieces
// of a cell are in the order of the images, then of their first rows; the one with the soma comes first.
std::vector<Piece> cut(const Tissue &tissue, const Slab &slab);

} // namespace conceg::block
