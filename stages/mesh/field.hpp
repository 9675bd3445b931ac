// SPDX-License-Identifier: BSD-3-Clause
// The signed distance field of every label in blocks of 16^3 cubes. A label is (cell, periodic lift): the
// image of the cell moved by lift * side. Values are separated, so that the insides of two labels never meet
// (README, equation 3).
#pragma once

#include "cones.hpp"
#include "parallel.hpp"

namespace conceg::mesh {

constexpr int kHalo = 1;                     // nodes around a block, so that all edges of its nodes are in it
constexpr int kRow = kBlock + 1 + 2 * kHalo; // nodes along the edge of a block with its halo
constexpr int kNodes = kRow * kRow * kRow;
constexpr float kFar = 1e9f; // value of nodes out of reach

// One cone image that some node of a block can feel.
struct IndexEntry {
  std::uint32_t cone;
  std::int16_t lift[3];
};

// Entries of each block, sorted by (cell, lift, cone); blocks that hold none do not appear.
struct Index {
  std::vector<IndexEntry> entry;
  std::vector<std::uint32_t> block;
  std::vector<std::uint64_t> offset; // block.size() + 1
};

Index make_index(const Scene &scene, Workers &workers, const Progress &progress);

struct Label {
  std::uint32_t cell;
  glm::ivec3 lift;
};

// The labels of one block and their separated values, node (x, y, z) at (z * kRow + y) * kRow + x.
struct BlockField {
  glm::ivec3 first{}; // node at local (0, 0, 0), which is in the halo
  glm::ivec3 cubes{}; // cubes of this block, at most kBlock on each axis; the first is at local (1, 1, 1)
  std::vector<Label> label;
  std::vector<float> value;           // label.size() * kNodes, units of distance
  std::vector<float> nearest, second; // per node: smallest and second smallest value before the separation
  std::vector<std::uint32_t> owner;   // per node: the label of the smallest
  float *of(std::size_t i) { return value.data() + i * kNodes; }
  const float *of(std::size_t i) const { return value.data() + i * kNodes; }
  // How far the nearest other label is from a node.
  float other(std::size_t i, int node) const {
    const auto n = static_cast<std::size_t>(node);
    return owner[n] == i ? second[n] : nearest[n];
  }
};

// Evaluates the row-th block of the index; `out` is reused storage.
void evaluate_block(const Scene &scene, const Index &index, std::size_t row, BlockField &out);

// Exact distance of a point (voxels, unwrapped) to one cone, in units. Double precision, for single points.
double cone_distance(const Grid &grid, const Cone &cone, const glm::dvec3 &voxel);

// The same, or `most` where it is not less: most cones are farther away than that, which is known cheaply.
double cone_distance_below(const Grid &grid, const Cone &cone, const glm::dvec3 &voxel, double most);

// Where a point given in unwrapped voxels lies: the row of its block, and the lift that brings it into the
// box.
struct Place {
  std::int64_t row = -1; // of the index; -1: no cone is within reach of the block
  glm::ivec3 lift{};
};
Place place_of(const Grid &grid, const Index &index, const glm::dvec3 &voxel);

// The cone of `cell` nearest to a point given in unwrapped voxels; -1 when none is within reach of the
// point's block.
std::int64_t nearest_cone(const Scene &scene, const Index &index, std::uint32_t cell,
                          const glm::dvec3 &voxel);

} // namespace conceg::mesh
