// SPDX-License-Identifier: BSD-3-Clause
// Marching tetrahedra on the Freudenthal split of the common grid, one label in one block. All crossings that
// lie nearest to one grid node become one vertex, their mean, where the surface stays a surface (README,
// light mesh).
#pragma once

#include "field.hpp"

#include <glm/common.hpp>

#include <functional>

namespace conceg::mesh {

constexpr int kOffset = 1 << 14;   // steps of a vertex's offset in a voxel
constexpr float kRoomUnit = 1024;  // steps of `room` in a unit of distance
constexpr float kRoomMost = 63.0f; // units; farther neighbours are as good as none

// A vertex is named by its node in the block and one of 7 edge directions, as bits x, y, z: the crossing on
// that edge. Direction 0: all crossings nearest to the node.
struct ChunkVertex {
  std::uint16_t name;     // local node * 8 + direction
  std::int16_t offset[3]; // from the node
  std::uint16_t room;     // distance to the nearest other label
};
static_assert(kNodes * 8 <= 1 << 16, "names of vertices have 16 bits");

struct ChunkFace {
  std::uint16_t corner[3]; // vertices of the chunk
};

// What one block gives to one cell.
struct Chunk {
  std::uint32_t row = 0; // of the index
  glm::ivec3 lift{};     // the cell's image in this block is moved by lift boxes
  glm::ivec3 first{};    // unwrapped node at local (0, 0, 0)
  std::vector<ChunkVertex> vertex;
  std::vector<ChunkFace> face;
};

// Does an unwrapped node keep its crossings apart?
using KeepsApart = std::function<bool(const glm::ivec3 &node)>;

// Marches one label of a block. `apart` empty: no node keeps its crossings apart.
class Marcher {
public:
  Marcher();
  // False when the label's surface does not pass through the block. `cluster` false: the base mesh.
  bool run(const BlockField &field, std::size_t label, const glm::ivec3 &size, bool cluster,
           const KeepsApart &apart, Chunk &out);

private:
  struct Crossing {
    float part, room; // of the edge from its lower node
  };
  void sign_rows(const glm::ivec3 &cubes);
  void march_row(int y, int z, int width, Chunk &out);
  std::uint32_t vertex(int x, int y, int z, int corner, int direction, Chunk &out);
  std::uint32_t cluster_at(int node, const glm::ivec3 &at, Chunk &out);
  std::uint32_t add(int node, int direction, const glm::vec3 &offset, float room, Chunk &out);
  Crossing crossing(int low, int high) const;
  float room_at(int node) const { return std::min(field_->other(label_, node), kRoomMost); }

  const BlockField *field_ = nullptr;
  const KeepsApart *apart_ = nullptr;
  const float *value_ = nullptr;
  std::size_t label_ = 0;
  bool cluster_ = true;
  std::uint32_t sign_[kRow][kRow] = {};
  std::vector<std::uint32_t> slot_, used_;
};

} // namespace conceg::mesh
