// SPDX-License-Identifier: BSD-3-Clause
// Drawing a donor and trees for each cell, turning them, and writing out the bars that the cell is asked to
// grow. Lengths in um.
#pragma once

#include "dictionary.hpp"
#include "pool.hpp"

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::place {

struct DonorOptions {
  glm::dvec3 pia = {0, 0, 1};     // unit vector
  bool axons = false;             // also the axon trees of the donors
  bool independent_trees = false; // each tree from any donor of the entry, instead of all from the cell's own
  bool drawn_angles = false;      // fork angles from the entry's distribution instead of the donor's own
  double min_radius_um = 0.15;    // floor of the radius law
  std::uint64_t seed = 1;
};

// Row of one of the pool's donors, each as likely as the others; the pool has at least one.
std::size_t draw_donor(const Pool &pool, std::uint64_t cell_id, std::uint64_t seed);

// The turn from the donor's frame (+z towards the pia) into the box: a random azimuth about the pia, or a
// uniform random rotation where the donor's frame is unknown.
glm::dquat draw_rotation(const Dictionary &dictionary, std::size_t donor, std::uint64_t cell_id,
                         const DonorOptions &options);

// Bars of all cells, one after another; spec/schema.yaml, /bars.
struct Bars {
  std::vector<std::uint64_t> cell_offset = {0};
  std::vector<std::uint32_t> tree;
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> neurite;
  std::vector<double> start, end, angle, radius, taper, radius_floor;
  std::vector<glm::dvec3> attractor; // unwrapped
};

struct CellDraw {
  std::uint64_t id;
  std::size_t donor;
  glm::dquat rotation;
  glm::dvec3 soma;
  double radius_scale;
  double dendrite_length = 1.0; // of dendritic bars, over the donor's
};

struct TreeDraw {
  std::size_t tree;    // row
  glm::dquat rotation; // from the frame of the tree's donor into the box
};

// A tree for each one that the cell's donor has, in the donor's order: that tree itself, or (independent
// trees) any of the pool's trees of the same neurite kind, each as likely as the others.
std::vector<TreeDraw> draw_trees(const Dictionary &dictionary, const Pool &pool, const CellDraw &cell,
                                 const DonorOptions &options);

// Appends the bars of one cell, tree by tree, parents before children.
void append_cell(const Dictionary &dictionary, const Pool &pool, const CellDraw &cell,
                 const DonorOptions &options, Bars &bars);

} // namespace conceg::place
