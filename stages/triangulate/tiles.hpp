// SPDX-License-Identifier: GPL-3.0-or-later
// Cutting the box into tiles, and gathering every copy of a node (periodic image, or reflection at an open
// side) that lies in a tile or in the halo around it. Lengths in um.
#pragma once

#include "conceg/geom.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::triangulate {

constexpr std::uint32_t kGhost =
    0xffffffffu; // node of a copy that pads an open side and takes no part in the network

// A copy of a node: position = node position + shift * side. `core` copies are the tile's own nodes.
struct Copy {
  glm::dvec3 position;
  std::uint32_t node;
  std::array<std::int8_t, 3> shift;
  bool core;
};

// Nodes sorted into buckets: equal boxes, a few node spacings wide, that tile the domain.
class Buckets {
public:
  Buckets(const conceg_box &box, const std::vector<glm::dvec3> &nodes, double bucket_um);

  const conceg_box &box() const { return box_; }
  std::int64_t count(int axis) const { return count_[axis]; }
  double edge(int axis, std::int64_t bucket) const;
  // Number of nodes in buckets first[a] .. last[a] - 1 on each axis.
  std::uint64_t nodes_within(const std::array<std::int64_t, 3> &first,
                             const std::array<std::int64_t, 3> &last) const;

private:
  friend struct Gather;
  conceg_box box_;
  const std::vector<glm::dvec3> &nodes_;
  std::array<std::int64_t, 3> count_;
  std::array<double, 3> width_;
  std::vector<std::uint64_t> offset_; // of each bucket into node_
  std::vector<std::uint32_t> node_;   // ascending within a bucket
};

// A tile: the nodes of buckets first[a] .. last[a] - 1 on each axis.
struct Tile {
  std::array<std::int64_t, 3> first, last;
};

// The part of space that a tile's copies fill completely.
struct Region {
  std::array<double, 3> lo, hi;
};

// Equal tiles of at most `tile_um` on a side, and at least `least` of them where the buckets allow it. One
// with more than `most_nodes` nodes is halved, again and again.
std::vector<Tile> cut_tiles(const Buckets &buckets, double tile_um, std::size_t least,
                            std::uint64_t most_nodes);

Region region_of(const Buckets &buckets, const Tile &tile, double halo_um);

// All copies in the tile and its halo; core copies first, in ascending order of their node.
std::vector<Copy> gather_copies(const Buckets &buckets, const Tile &tile, double halo_um);

// The paper's network: every node once, in order, then a node on the lower face of a periodic axis once more
// on each upper face that it meets. All are core copies.
std::vector<Copy> gather_mirrored(const conceg_box &box, const std::vector<glm::dvec3> &nodes);

} // namespace conceg::triangulate
