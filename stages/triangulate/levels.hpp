// SPDX-License-Identifier: GPL-3.0-or-later
// How fine the nodes are in each cell of the lattice: spacing / 2^level. Lengths in um.
#pragma once

#include "lattice.hpp"
#include "radius.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::triangulate {

// A ball whose cells (those with their centre in it) get at least this level.
struct Zone {
  glm::dvec3 center;
  double radius_um;
  unsigned level;
};

// Balls around each soma: level `finest` up to `distance_um` off its surface, and each coarser one as far
// again.
std::vector<Zone> soma_zones(const std::vector<Soma> &somas, unsigned finest, double distance_um);

// One level per cell of the lattice. Cells that lie wholly in a soma stay at 0: nothing grows there. Then
// cells that meet at a face, an edge or a corner differ by one level at most, across periodic sides too.
std::vector<std::uint8_t> grade_levels(const Lattice &lattice, const std::vector<Zone> &zones,
                                       const std::vector<Soma> &somas);

// Number of nodes that stand in cells of each level.
std::array<std::uint64_t, kFinestLevel + 1> nodes_by_level(const std::vector<std::uint8_t> &levels);

} // namespace conceg::triangulate
