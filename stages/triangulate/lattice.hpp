// SPDX-License-Identifier: GPL-3.0-or-later
// The body-centred cubic lattice that nodes are made from: cubic cells of two nodes each, which fit the box.
// A cell of level l is cut into 8^l smaller ones. Lengths in um.
#pragma once

#include "conceg/geom.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::triangulate {

constexpr unsigned kFinestLevel = 2; // 64 times the density; nodes of a cell are numbered in 10 bits

struct Lattice {
  conceg_box box;
  std::array<std::uint64_t, 3> cells; // along each axis; cell x + cells[0] * (y + cells[1] * z)

  std::uint64_t count() const { return cells[0] * cells[1] * cells[2]; }
  double width(int axis) const { return conceg_box_side(&box, axis) / static_cast<double>(cells[axis]); }
};

// Side of the cubic cell that holds two nodes, before it is fitted to the box.
double cell_side(double density_per_um3);

Lattice lattice_of(const conceg_box &box, double density_per_um3);

constexpr std::uint64_t nodes_in_cell(unsigned level) {
  return std::uint64_t{2} << 3 * level;
}

// Node `k` of a cell. A stream of its own draws its shift, so that it depends on nothing but its name.
glm::dvec3 lattice_node(const Lattice &lattice, std::uint64_t cell, unsigned level, std::uint64_t k,
                        double jitter, std::uint64_t seed);

// No sphere with this radius is empty, whatever was drawn and whichever cells are cut.
double empty_radius_um(const Lattice &lattice, double jitter, bool graded);

// What nodes there are of each cell, by number over all cells.
class CellNodes {
public:
  // `levels`: one per cell, or none where all are 0.
  CellNodes(const Lattice &lattice, const std::vector<std::uint8_t> &levels);

  std::uint64_t count() const { return levels_.empty() ? 2 * lattice_.count() : first_.back(); }
  // The cell of node i; `hint` is a cell that is not behind it.
  std::uint64_t cell_of(std::uint64_t i, std::uint64_t hint) const;
  std::uint64_t cell_of(std::uint64_t i) const;
  glm::dvec3 node(std::uint64_t i, std::uint64_t cell, double jitter, std::uint64_t seed) const;

private:
  const Lattice lattice_;
  const std::vector<std::uint8_t> &levels_;
  std::vector<std::uint64_t> first_; // node of each cell, and the number of nodes; empty without levels
};

} // namespace conceg::triangulate
