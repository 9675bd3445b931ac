// SPDX-License-Identifier: BSD-3-Clause
// The surface of one cell in unwrapped coordinates, from the pieces that its blocks gave.
#pragma once

#include "chunk_file.hpp"
#include "surface.hpp"

#include <algorithm>
#include <unordered_set>

namespace conceg::mesh {

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
  // As plain numbers, in ascending order, to be kept and taken back.
  std::vector<std::uint64_t> nodes() const {
    std::vector<std::uint64_t> out(nodes_.begin(), nodes_.end());
    std::sort(out.begin(), out.end());
    return out;
  }
  void add(const std::vector<std::uint64_t> &nodes) { nodes_.insert(nodes.begin(), nodes.end()); }

private:
  static std::uint64_t key(const glm::ivec3 &c) {
    const auto bits = [](int i) { return static_cast<std::uint64_t>(i) & 0x1fffff; };
    return bits(c.z) << 42 | bits(c.y) << 21 | bits(c.x);
  }
  std::unordered_set<std::uint64_t> nodes_;
};

// Which rows of the index hold an image of a cell: the cells' rows, ascending. `wanted` is per cell.
struct RowCount {
  std::vector<std::uint32_t> row;  // that hold a wanted cell
  std::vector<std::uint32_t> rows; // per cell: how many of them hold it
};
RowCount rows_of(const Scene &scene, const Index &index, const std::vector<std::uint8_t> &wanted);

// The chunks of the wanted cells in one row, with the cells that are in it, each once.
void march_row(const Scene &scene, const Index &index, std::uint32_t row, bool cluster,
               const std::vector<std::uint8_t> &wanted, const std::vector<Apart> &apart,
               std::vector<ChunkFile::Marched> &out, std::vector<std::uint32_t> &cells);

// One closed manifold surface from a cell's chunks, relative to `origin`, with `room`. Nodes whose clusters
// spoil it are added to `apart` and marched again. The order of vertices and faces follows the unwrapped
// grid, not the blocks, so that it does not depend on where the box begins.
Surface join_cell(const Scene &scene, const Index &index, std::uint32_t cell, const glm::dvec3 &origin,
                  std::vector<Chunk> &chunks, Apart &apart);

} // namespace conceg::mesh
