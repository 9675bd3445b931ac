// SPDX-License-Identifier: BSD-3-Clause
#include "extract.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>

namespace conceg::mesh {
namespace {

// An edge of the split runs from a lower node along (dx, dy, dz) in {0, 1}^3. In a cube: lower corner and
// direction, as bits.
struct CubeEdge {
  int corner, direction;
};
using CubeFace = std::array<CubeEdge, 3>;

// The triangles of a cube for each pattern of inside corners (bit = corner, x + 2 y + 4 z).
class CubeTable {
public:
  CubeTable() {
    int axes[3] = {0, 1, 2};
    do {
      const bool even = axes[1] == (axes[0] + 1) % 3;
      const std::array<int, 4> corner = {0, 1 << axes[0], (1 << axes[0]) | (1 << axes[1]), 7};
      for (int inside = 0; inside < 256; inside++)
        add_tetrahedron(inside, corner, even);
    } while (std::next_permutation(axes, axes + 3));
  }
  const std::vector<CubeFace> &operator[](int inside) const {
    return faces_[static_cast<std::size_t>(inside)];
  }

private:
  void add_tetrahedron(int inside, const std::array<int, 4> &corner, bool even) {
    int in[4], out[4], ins = 0, outs = 0;
    for (int i = 0; i < 4; i++)
      (inside >> corner[i] & 1 ? in[ins++] : out[outs++]) = i;
    if (ins == 1) add_corner(inside, corner, in[0], even);
    if (ins == 3) add_corner(inside, corner, out[0], !even);
    if (ins == 2) {
      const bool turned = parity({in[0], in[1], out[0], out[1]}) ^ !even;
      const CubeEdge a = edge(corner, in[0], out[0]), b = edge(corner, in[0], out[1]),
                     c = edge(corner, in[1], out[1]), d = edge(corner, in[1], out[0]);
      add(inside, {a, b, c}, turned);
      add(inside, {a, c, d}, turned);
    }
  }
  // The triangle that cuts off one corner, facing away from it where the tetrahedron is positive.
  void add_corner(int inside, const std::array<int, 4> &corner, int lone, bool positive) {
    static constexpr int others[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    add(inside,
        {edge(corner, lone, others[lone][0]), edge(corner, lone, others[lone][1]),
         edge(corner, lone, others[lone][2])},
        !positive);
  }
  void add(int inside, CubeFace face, bool turned) {
    if (turned) std::swap(face[1], face[2]);
    faces_[static_cast<std::size_t>(inside)].push_back(face);
  }
  static CubeEdge edge(const std::array<int, 4> &corner, int i, int j) {
    return {corner[std::min(i, j)], corner[i] ^ corner[j]};
  }
  static bool parity(const std::array<int, 4> &order) {
    bool odd = false;
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4; j++)
        odd ^= order[i] > order[j];
    return odd;
  }
  std::array<std::vector<CubeFace>, 256> faces_;
};

// What one block gives to one cell: vertices by their key, triangles by chunk-local vertex.
struct Chunk {
  std::uint32_t cell;
  std::vector<std::uint64_t> key;
  std::vector<float> part; // of the edge, from its lower node
  std::vector<glm::uvec3> face;
};

constexpr int kKeyBits = 20, kKeyOffset = 1 << (kKeyBits - 1);

std::uint64_t key_of(const glm::ivec3 &node, int direction) {
  const auto bits = [](int n) { return static_cast<std::uint64_t>(n + kKeyOffset); };
  return (((bits(node.z) << kKeyBits | bits(node.y)) << kKeyBits | bits(node.x)) << 3) |
         static_cast<std::uint64_t>(direction);
}

glm::ivec3 node_of(std::uint64_t key) {
  constexpr std::uint64_t mask = (1u << kKeyBits) - 1;
  const auto node = [&](int axis) {
    return static_cast<int>(key >> (3 + axis * kKeyBits) & mask) - kKeyOffset;
  };
  return {node(0), node(1), node(2)};
}

glm::dvec3 voxel_of(std::uint64_t key, float part) {
  return glm::dvec3(node_of(key)) + double(part) * glm::dvec3(key & 1, key >> 1 & 1, key >> 2 & 1);
}

// Every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

// Place of a key on a space-filling curve (Morton) through the nodes, seen from the cell's own node:
// neighbours in space are neighbours in memory, which is what simplification is bound by.
std::uint64_t curve(std::uint64_t key, const glm::ivec3 &centre) {
  constexpr std::uint64_t mask = (1u << kKeyBits) - 1;
  const glm::ivec3 node = node_of(key) - centre + kKeyOffset;
  const auto bits = [&](int n) { return spread(static_cast<std::uint64_t>(n) & mask); };
  return (bits(node.z) << 2 | bits(node.y) << 1 | bits(node.x)) << 3 | (key & 7);
}

constexpr std::uint32_t kNone = 0xffffffffu;

// Marching tetrahedra of one label in one block.
class Marcher {
public:
  Marcher() : slot_(std::size_t(kNodes) * 7, kNone) {}

  // False when the label's surface does not pass through the block.
  bool run(const BlockField &field, std::size_t label, const glm::ivec3 &size, Chunk &out) {
    value_ = field.of(label);
    base_ = field.first - field.label[label].lift * size;
    out.cell = field.label[label].cell;
    sign_rows(field.cubes);
    for (int z = 0; z < field.cubes.z; z++)
      for (int y = 0; y < field.cubes.y; y++)
        march_row(y, z, field.cubes.x, out);
    for (const std::uint32_t slot : used_)
      slot_[slot] = kNone;
    used_.clear();
    return !out.face.empty();
  }

private:
  void sign_rows(const glm::ivec3 &cubes) {
    for (int z = 0; z <= cubes.z; z++)
      for (int y = 0; y <= cubes.y; y++) {
        const float *row = value_ + (z * kRow + y) * kRow;
        std::uint32_t bits = 0;
        for (int x = 0; x < kRow; x++)
          bits |= static_cast<std::uint32_t>(row[x] < 0) << x;
        sign_[z][y] = bits;
      }
  }

  void march_row(int y, int z, int width, Chunk &out) {
    const std::uint32_t a = sign_[z][y], b = sign_[z][y + 1], c = sign_[z + 1][y], d = sign_[z + 1][y + 1];
    const std::uint32_t any = a | b | c | d, all = a & b & c & d;
    const std::uint32_t mixed = (any | any >> 1) & ~(all & all >> 1) & ((1u << width) - 1);
    for (std::uint32_t rest = mixed; rest; rest &= rest - 1) {
      const int x = __builtin_ctz(rest);
      const auto pair = [x](std::uint32_t bits) { return static_cast<int>(bits >> x & 3); };
      const int inside = pair(a) | pair(b) << 2 | pair(c) << 4 | pair(d) << 6;
      for (const CubeFace &face : table()[inside])
        out.face.push_back(
            {vertex(x, y, z, face[0], out), vertex(x, y, z, face[1], out), vertex(x, y, z, face[2], out)});
    }
  }

  std::uint32_t vertex(int x, int y, int z, const CubeEdge &edge, Chunk &out) {
    const int dx = edge.direction & 1, dy = edge.direction >> 1 & 1, dz = edge.direction >> 2;
    x += edge.corner & 1, y += edge.corner >> 1 & 1, z += edge.corner >> 2;
    const int node = (z * kRow + y) * kRow + x;
    const auto slot = static_cast<std::uint32_t>(node * 7 + edge.direction - 1);
    if (slot_[slot] == kNone) {
      const float low = value_[node], high = value_[node + (dz * kRow + dy) * kRow + dx];
      slot_[slot] = static_cast<std::uint32_t>(out.key.size());
      used_.push_back(slot);
      out.key.push_back(key_of(base_ + glm::ivec3(x, y, z), edge.direction));
      out.part.push_back(low / (low - high));
    }
    return slot_[slot];
  }

  static const CubeTable &table() {
    static const CubeTable instance;
    return instance;
  }

  const float *value_ = nullptr;
  glm::ivec3 base_{};
  std::uint32_t sign_[kRow][kRow] = {};
  std::vector<std::uint32_t> slot_, used_;
};

// Faces in a canonical order: smallest vertex first, then by their vertices.
void order_faces(std::vector<glm::uvec3> &faces, std::size_t vertices) {
  std::vector<std::uint32_t> start(vertices + 1);
  for (glm::uvec3 &f : faces) {
    while (f.x > f.y || f.x > f.z)
      f = {f.y, f.z, f.x};
    start[f.x + 1]++;
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<glm::uvec3> sorted(faces.size());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (const glm::uvec3 &f : faces)
    sorted[next[f.x]++] = f;
  for (std::size_t v = 0; v < vertices; v++)
    std::sort(sorted.begin() + start[v], sorted.begin() + start[v + 1],
              [](const glm::uvec3 &l, const glm::uvec3 &r) { return l.y != r.y ? l.y < r.y : l.z < r.z; });
  faces.swap(sorted);
}

// Joins a cell's chunks: equal keys are one vertex.
Surface join(const Grid &grid, std::vector<Chunk *> &chunks, std::uint32_t cell, const glm::dvec3 &origin) {
  Surface surface;
  surface.cell = cell, surface.origin = origin;
  struct Found {
    std::uint64_t place, key;
    std::uint32_t index;
    float part;
  };
  std::vector<Found> found;
  const glm::dvec3 centre = grid.voxel_of(origin);
  const glm::ivec3 own(glm::floor(centre));
  std::size_t vertices = 0, faces = 0;
  for (const Chunk *chunk : chunks)
    vertices += chunk->key.size(), faces += chunk->face.size();
  if (vertices >= kNone)
    fail(CONCEG_E_RANGE, "cell %u: its surface has too many vertices (%zu); use a larger h_um", cell,
         vertices);
  found.reserve(vertices);
  for (const Chunk *chunk : chunks)
    for (std::size_t i = 0; i < chunk->key.size(); i++)
      found.push_back({curve(chunk->key[i], own), chunk->key[i], static_cast<std::uint32_t>(found.size()),
                       chunk->part[i]});
  std::sort(found.begin(), found.end(), [](const Found &l, const Found &r) {
    return l.place != r.place ? l.place < r.place : l.index < r.index;
  });
  std::vector<std::uint32_t> number(vertices);
  for (std::size_t i = 0; i < found.size(); i++) {
    if (i == 0 || found[i].key != found[i - 1].key)
      surface.vertex.push_back(written((voxel_of(found[i].key, found[i].part) - centre) * grid.step));
    number[found[i].index] = static_cast<std::uint32_t>(surface.vertex.size() - 1);
  }
  surface.face.reserve(faces);
  std::uint32_t base = 0;
  for (Chunk *chunk : chunks) {
    for (const glm::uvec3 &f : chunk->face)
      surface.face.push_back({number[base + f.x], number[base + f.y], number[base + f.z]});
    base += static_cast<std::uint32_t>(chunk->key.size());
    *chunk = Chunk();
  }
  order_faces(surface.face, surface.vertex.size());
  return surface;
}

} // namespace

std::vector<Surface> extract_surfaces(const Scene &scene, const Index &index,
                                      const std::vector<glm::dvec3> &origin, Workers &workers,
                                      const Progress &progress) {
  std::vector<std::vector<Chunk>> blocks(index.block.size());
  std::atomic<std::uint64_t> done{0};
  workers.loop(blocks.size(), 1, [&](std::size_t row, unsigned) {
    static thread_local BlockField field;
    static thread_local Marcher marcher;
    evaluate_block(scene, index, row, field);
    for (std::size_t label = 0; label < field.label.size(); label++) {
      Chunk chunk;
      if (marcher.run(field, label, scene.grid.size, chunk)) blocks[row].push_back(std::move(chunk));
    }
    const std::uint64_t count = ++done;
    if (count % 64 == 0) report(progress, "mesh: extract", count, blocks.size());
  });
  std::vector<std::vector<Chunk *>> of_cell(scene.cells);
  for (auto &block : blocks)
    for (Chunk &chunk : block)
      of_cell[chunk.cell].push_back(&chunk);
  std::vector<Surface> surfaces(scene.cells);
  done = 0;
  workers.loop(scene.cells, 1, [&](std::size_t cell, unsigned) {
    surfaces[cell] = join(scene.grid, of_cell[cell], static_cast<std::uint32_t>(cell), origin[cell]);
    report(progress, "mesh: join", ++done, scene.cells);
  });
  return surfaces;
}

} // namespace conceg::mesh
