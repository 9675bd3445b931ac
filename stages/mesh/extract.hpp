// SPDX-License-Identifier: BSD-3-Clause
// The surfaces of all cells in unwrapped coordinates: blocks are marched once and kept as chunks, a cell's
// chunks are joined when its surface is wanted.
#pragma once

#include "march.hpp"
#include "surface.hpp"

#include <unordered_set>

namespace conceg::mesh {

// Chunks of each cell, in the order of blocks.
using Chunks = std::vector<std::vector<Chunk>>;

Chunks march_blocks(const Scene &scene, const Index &index, bool cluster, Workers &workers,
                    const Progress &progress);

struct NodeBox {
  glm::ivec3 low, high; // unwrapped nodes, both in it
};

// The places of one cell where the crossings of the grid's edges are not clustered: the base mesh.
class Apart {
public:
  bool whole = false;
  void add(const NodeBox &box) {
    for (int z = box.low.z; z <= box.high.z; z++)
      for (int y = box.low.y; y <= box.high.y; y++)
        for (int x = box.low.x; x <= box.high.x; x++)
          nodes_.insert(key({x, y, z}));
  }
  bool holds(const glm::ivec3 &node) const { return whole || nodes_.count(key(node)); }
  bool empty() const { return !whole && nodes_.empty(); }

private:
  static std::uint64_t key(const glm::ivec3 &c) {
    const auto bits = [](int i) { return static_cast<std::uint64_t>(i) & 0x1fffff; };
    return bits(c.z) << 42 | bits(c.y) << 21 | bits(c.x);
  }
  std::unordered_set<std::uint64_t> nodes_;
};

// Marches again those chunks of the cells that one of their places meets; all of them when `apart.whole`.
// `apart` and `places` are per cell.
void march_again(const Scene &scene, const Index &index, const std::vector<std::uint32_t> &cells,
                 const std::vector<Apart> &apart, const std::vector<std::vector<NodeBox>> &places,
                 Workers &workers, Chunks &chunks);

// One closed manifold surface from a cell's chunks, relative to `origin`, with `room`. Nodes whose clusters
// spoil it are added to `apart` and marched again. The order of vertices and faces follows the unwrapped
// grid, not the blocks, so that it does not depend on where the box begins.
Surface join_cell(const Scene &scene, const Index &index, std::uint32_t cell, const glm::dvec3 &origin,
                  std::vector<Chunk> &chunks, Apart &apart);

} // namespace conceg::mesh
