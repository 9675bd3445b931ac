// SPDX-License-Identifier: BSD-3-Clause
// The skeletons of all cells as bodies: nodes that move, and round cones (elements) between them. Lengths in
// um.
#pragma once

#include "wrap.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace conceg::relax {

// Skeletons as they stand in the document; rows of cell i are cell_offset[i] .. cell_offset[i + 1].
struct Skeletons {
  std::vector<std::uint64_t> cell_offset;
  std::vector<glm::dvec3> position; // unwrapped
  std::vector<float> radius, target_radius;
  std::vector<std::int64_t> parent; // row within the cell, -1 = soma
  std::vector<glm::dvec3> soma;     // per cell
  std::vector<float> soma_radius;   // per cell, 0 = no soma
};

// A round cone from node a to node b; its radius runs from radius[radius_a] to radius[radius_b].
// Element i < points ends at point i; then one sphere (a = b) per soma.
struct Element {
  std::uint32_t a, b, radius_a, radius_b, cell;
};

// Up to chunk_size consecutive elements of one chain: one primitive of the collision search.
struct Chunk {
  std::uint32_t first, count;
};

struct Bodies {
  std::size_t points = 0;           // nodes: the points, the soma centres, the inner ends of the root stubs
  std::vector<glm::dvec3> position; // per node
  std::vector<double> radius;       // per node that owns a radius: points, then somas
  std::vector<double> floor;        // the least radius of each
  std::vector<std::uint8_t> pinned; // per node
  std::vector<std::int64_t> parent; // per point, global; -1 = root
  std::vector<std::uint32_t> child_offset, child; // CSR of the children of each point
  std::vector<double> path;                       // per point, path length from its root at the start
  std::vector<double> rest_length;                // per point, of the segment that ends there; 0 for a root
  std::vector<glm::dvec3> rest_bend; // per point, offset from the middle of its neighbours at the start
  std::vector<Element> elements;
  std::vector<Chunk> chunks;
  std::vector<double>
      reach_radius; // per radius: the largest that it may get, for bounds and near-in-tree tests
};

constexpr std::uint32_t chunk_size = 4;

// Checks the skeletons and builds the bodies with their target radii. `radius_min` is the least radius asked
// for; a point whose target is thinner has its target as its floor. E_RANGE / E_FORMAT with dataset[index] on
// bad input.
Bodies make_bodies(const Skeletons &skeletons, double radius_min);

// Offset of point i from the middle of its neighbours (parent and children); 0 where it has fewer than two.
glm::dvec3 bend_of(const Bodies &bodies, std::size_t point);

// True when two elements of one copy of one cell are neighbours in the tree: joined, within a few radii of
// path, siblings near their fork, or a root near its own soma. Such pairs are one body and never collide.
bool near_in_tree(const Bodies &bodies, std::uint32_t e, std::uint32_t f);

} // namespace conceg::relax
