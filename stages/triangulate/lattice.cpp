// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice.hpp"

#include "conceg/portable.h"
#include "conceg/rng.h"

#include <algorithm>
#include <cmath>

namespace conceg::triangulate {

double cell_side(double density_per_um3) {
  return conceg_pow(2.0 / density_per_um3, 1.0 / 3.0);
}

Lattice lattice_of(const conceg_box &box, double density_per_um3) {
  const double side = cell_side(density_per_um3);
  Lattice lattice{box, {}};
  for (int axis = 0; axis < 3; axis++)
    lattice.cells[axis] =
        std::max<std::uint64_t>(1, static_cast<std::uint64_t>(conceg_box_side(&box, axis) / side + 0.5));
  return lattice;
}

glm::dvec3 lattice_node(const Lattice &lattice, std::uint64_t cell, unsigned level, std::uint64_t k,
                        double jitter, std::uint64_t seed) {
  conceg_rng rng = level == 0 ? conceg_rng_stream(seed, "triangulate.bcc", cell << 1 | k)
                              : conceg_rng_stream(seed, "triangulate.graded", cell << 12 | level << 10 | k);
  const std::uint64_t body = k & 1, part = k >> 1; // corner or centre node of that part of the cell
  const std::array<std::uint64_t, 3> at = {cell % lattice.cells[0],
                                           cell / lattice.cells[0] % lattice.cells[1],
                                           cell / lattice.cells[0] / lattice.cells[1]};
  const std::uint64_t parts = std::uint64_t{1} << level; // along each axis
  glm::dvec3 position;
  for (int axis = 0; axis < 3; axis++) {
    const double width =
        conceg_box_side(&lattice.box, axis) / static_cast<double>(lattice.cells[axis] * parts);
    const std::uint64_t index = at[axis] * parts + (part >> level * static_cast<unsigned>(axis)) % parts;
    const double shift = jitter * (2.0 * conceg_rng_uniform(&rng) - 1.0);
    // A quarter off the part's faces: a jitter below a quarter keeps the node inside, away from all others.
    position[axis] = conceg_snap(lattice.box.lo[axis] + width * (static_cast<double>(index) + 0.25 +
                                                                 0.5 * static_cast<double>(body) + shift));
  }
  return position;
}

double empty_radius_um(const Lattice &lattice, double jitter, bool graded) {
  double width = 0.0;
  for (int axis = 0; axis < 3; axis++)
    width = std::max(width, lattice.width(axis));
  const double covering = std::sqrt(5.0) / 4.0, diagonal = std::sqrt(3.0);
  // In a cut cell a node stands within sqrt(3) / 8 of where the uncut one was, and is shifted by half as
  // much.
  const double uncut = diagonal * jitter, cut = diagonal * (0.125 + 0.5 * jitter);
  return width * (covering + (graded ? std::max(uncut, cut) : uncut)) + CONCEG_LATTICE_STEP_UM;
}

CellNodes::CellNodes(const Lattice &lattice, const std::vector<std::uint8_t> &levels)
    : lattice_(lattice), levels_(levels) {
  if (levels.empty()) return;
  first_.resize(levels.size() + 1);
  for (std::size_t cell = 0; cell < levels.size(); cell++)
    first_[cell + 1] = first_[cell] + nodes_in_cell(levels[cell]);
}

std::uint64_t CellNodes::cell_of(std::uint64_t i, std::uint64_t hint) const {
  if (levels_.empty()) return i / 2;
  while (first_[hint + 1] <= i)
    hint++;
  return hint;
}

std::uint64_t CellNodes::cell_of(std::uint64_t i) const {
  if (levels_.empty()) return i / 2;
  return static_cast<std::uint64_t>(std::upper_bound(first_.begin(), first_.end(), i) - first_.begin()) - 1;
}

glm::dvec3 CellNodes::node(std::uint64_t i, std::uint64_t cell, double jitter, std::uint64_t seed) const {
  if (levels_.empty()) return lattice_node(lattice_, cell, 0, i & 1, jitter, seed);
  return lattice_node(lattice_, cell, levels_[cell], i - first_[cell], jitter, seed);
}

} // namespace conceg::triangulate
