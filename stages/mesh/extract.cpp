// SPDX-License-Identifier: BSD-3-Clause
#include "extract.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <numeric>

namespace conceg::mesh {
namespace {

// A vertex of a cell: unwrapped node and direction.
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

glm::ivec3 local_node(int node) {
  return {node % kRow, node / kRow % kRow, node / (kRow * kRow)};
}

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

// Takes away vertices whose faces all shrank to nothing.
template <class... Values>
void drop_unused(std::vector<glm::uvec3> &face, std::vector<glm::vec3> &vertex, Values &...values) {
  std::vector<std::uint32_t> number(vertex.size());
  for (const glm::uvec3 &f : face)
    number[f.x] = number[f.y] = number[f.z] = 1;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < number.size(); v++)
    if (number[v]) {
      vertex[kept] = vertex[v], ((values[kept] = values[v]), ...);
      number[v] = kept++;
    }
  vertex.resize(kept), (values.resize(kept), ...);
  for (glm::uvec3 &f : face)
    f = {number[f.x], number[f.y], number[f.z]};
}

struct Joined {
  Surface surface;
  std::vector<std::uint64_t> key; // of each vertex
};

// Puts a cell's chunks together: equal keys are one vertex.
Joined put_together(const Grid &grid, std::uint32_t cell, const glm::dvec3 &origin,
                    const std::vector<Chunk> &chunks) {
  struct Found {
    std::uint64_t place, key;
    std::uint32_t index;
    const ChunkVertex *vertex;
  };
  Joined joined;
  Surface &surface = joined.surface;
  surface.cell = cell, surface.origin = origin;
  const glm::dvec3 centre = grid.voxel_of(origin);
  const glm::ivec3 own(glm::floor(centre));
  std::size_t vertices = 0, faces = 0;
  for (const Chunk &chunk : chunks)
    vertices += chunk.vertex.size(), faces += chunk.face.size();
  if (vertices >= 0xffffffffu)
    fail(CONCEG_E_RANGE, "cell %u: its surface has too many vertices (%zu); use a larger h_um", cell,
         vertices);
  std::vector<Found> found;
  found.reserve(vertices);
  for (const Chunk &chunk : chunks)
    for (const ChunkVertex &v : chunk.vertex) {
      const std::uint64_t key = key_of(chunk.first + local_node(v.name >> 3), v.name & 7);
      found.push_back({curve(key, own), key, static_cast<std::uint32_t>(found.size()), &v});
    }
  std::sort(found.begin(), found.end(), [](const Found &l, const Found &r) {
    return l.place != r.place ? l.place < r.place : l.index < r.index;
  });
  std::vector<std::uint32_t> number(vertices);
  for (std::size_t i = 0; i < found.size(); i++) {
    if (i == 0 || found[i].key != found[i - 1].key) {
      const ChunkVertex &v = *found[i].vertex;
      const glm::dvec3 voxel = glm::dvec3(node_of(found[i].key)) +
                               glm::dvec3(v.offset[0], v.offset[1], v.offset[2]) / double(kOffset);
      surface.vertex.push_back(written((voxel - centre) * grid.step));
      surface.room.push_back(static_cast<float>(v.room / double(kRoomUnit) * grid.unit));
      joined.key.push_back(found[i].key);
    }
    number[found[i].index] = static_cast<std::uint32_t>(surface.vertex.size() - 1);
  }
  surface.face.reserve(faces);
  std::uint32_t base = 0;
  for (const Chunk &chunk : chunks) {
    for (const ChunkFace &f : chunk.face)
      surface.face.push_back(
          {number[base + f.corner[0]], number[base + f.corner[1]], number[base + f.corner[2]]});
    base += static_cast<std::uint32_t>(chunk.vertex.size());
  }
  drop_unused(surface.face, surface.vertex, surface.room, joined.key);
  order_faces(surface.face, surface.vertex.size());
  return joined;
}

// Finds vertices around which a surface is not one fan of faces, with those that share the trouble.
class Fans {
public:
  explicit Fans(const Surface &surface) : surface_(surface) {
    start_.assign(surface.vertex.size() + 1, 0);
    for (const glm::uvec3 &f : surface.face)
      for (int i = 0; i < 3; i++)
        start_[f[i] + 1]++;
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    spoke_.resize(surface.face.size() * 3);
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (const glm::uvec3 &f : surface.face)
      for (int i = 0; i < 3; i++)
        spoke_[next[f[i]]++] = {f[(i + 1) % 3], f[(i + 2) % 3]};
  }
  // Adds to `bad` the vertex and those around it that its faces fail to go round by.
  bool one_fan(std::uint32_t v, std::vector<std::uint32_t> &bad) const {
    const Spoke *first = spoke_.data() + start_[v], *last = spoke_.data() + start_[v + 1];
    if (first == last) return true;
    const std::size_t before = bad.size();
    for (const Spoke *s = first; s != last; s++)
      if (count_from(first, last, s->from) != 1 || count_from(first, last, s->to) != 1)
        bad.push_back(count_from(first, last, s->from) != 1 ? s->from : s->to);
    std::ptrdiff_t visited = 0;
    if (bad.size() == before) {
      const Spoke *at = first;
      do {
        const std::uint32_t to = at->to;
        for (at = first; at->from != to;)
          at++;
        visited++;
      } while (at != first && visited <= last - first);
      if (visited == last - first) return true;
    }
    bad.push_back(v);
    return false;
  }
  void around(std::uint32_t v, std::vector<std::uint32_t> &out) const {
    for (std::uint32_t i = start_[v]; i < start_[v + 1]; i++)
      out.push_back(spoke_[i].from), out.push_back(spoke_[i].to);
  }

private:
  struct Spoke {
    std::uint32_t from, to;
  };
  static int count_from(const Spoke *first, const Spoke *last, std::uint32_t from) {
    int count = 0;
    for (; first != last; first++)
      count += first->from == from;
    return count;
  }
  const Surface &surface_;
  std::vector<std::uint32_t> start_;
  std::vector<Spoke> spoke_;
};

// The clustered nodes that keep a surface from being a manifold.
std::vector<NodeBox> spoilers(const Joined &joined) {
  std::vector<std::uint32_t> all;
  const Fans fans(joined.surface);
  const auto clustered = [&](std::uint32_t v) { return (joined.key[v] & 7) == 0; };
  for (std::uint32_t v = 0; v < joined.key.size(); v++) {
    std::vector<std::uint32_t> bad;
    if (fans.one_fan(v, bad)) continue;
    if (std::none_of(bad.begin(), bad.end(), clustered)) fans.around(v, bad);
    all.insert(all.end(), bad.begin(), bad.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<NodeBox> nodes;
  for (const std::uint32_t v : all)
    if (clustered(v)) nodes.push_back({node_of(joined.key[v]), node_of(joined.key[v])});
  return nodes;
}

bool touches(const Chunk &chunk, const NodeBox &box) {
  const glm::ivec3 low = box.low - chunk.first, high = box.high - chunk.first;
  for (int axis = 0; axis < 3; axis++)
    if (high[axis] < kHalo || low[axis] > kBlock + kHalo) return false;
  return true;
}

bool is_met(const Chunk &chunk, const Apart &apart, const std::vector<NodeBox> &places) {
  return apart.whole ||
         std::any_of(places.begin(), places.end(), [&](const NodeBox &box) { return touches(chunk, box); });
}

void march_again(const Scene &scene, const Index &index, std::uint32_t cell, const Apart &apart,
                 Chunk &chunk) {
  static thread_local BlockField field;
  static thread_local Marcher marcher;
  const std::uint32_t row = chunk.row;
  evaluate_block(scene, index, row, field);
  for (std::size_t label = 0; label < field.label.size(); label++)
    if (field.label[label].cell == cell && field.label[label].lift == chunk.lift) {
      marcher.run(
          field, label, scene.grid.size, true, [&](const glm::ivec3 &node) { return apart.holds(node); },
          chunk);
      chunk.row = row;
      return;
    }
}

} // namespace

RowCount rows_of(const Scene &scene, const Index &index, const std::vector<std::uint8_t> &wanted) {
  RowCount out;
  out.rows.resize(scene.cells);
  for (std::size_t row = 0; row < index.block.size(); row++) {
    bool any = false;
    for (std::uint64_t i = index.offset[row]; i < index.offset[row + 1]; i++) {
      const std::uint32_t cell = scene.cone[index.entry[i].cone].cell;
      const bool again = i > index.offset[row] && scene.cone[index.entry[i - 1].cone].cell == cell;
      if (again || !wanted[cell]) continue;
      out.rows[cell]++, any = true;
    }
    if (any) out.row.push_back(static_cast<std::uint32_t>(row));
  }
  return out;
}

void march_row(const Scene &scene, const Index &index, std::uint32_t row, bool cluster,
               const std::vector<std::uint8_t> &wanted, const std::vector<Apart> &apart,
               std::vector<ChunkFile::Marched> &out, std::vector<std::uint32_t> &cells) {
  static thread_local BlockField field;
  static thread_local Marcher marcher;
  static thread_local Chunk chunk;
  evaluate_block(scene, index, row, field);
  out.clear(), cells.clear();
  for (std::size_t label = 0; label < field.label.size(); label++) {
    const std::uint32_t cell = field.label[label].cell;
    if (!wanted[cell]) continue;
    if (cells.empty() || cells.back() != cell) cells.push_back(cell);
    const Apart &own = apart[cell];
    const KeepsApart keeps_apart =
        own.empty() ? KeepsApart() : [&own](const glm::ivec3 &node) { return own.holds(node); };
    if (!marcher.run(field, label, scene.grid.size, cluster, keeps_apart, chunk)) continue;
    chunk.row = row;
    out.push_back({cell, chunk});
  }
}

Surface join_cell(const Scene &scene, const Index &index, std::uint32_t cell, const glm::dvec3 &origin,
                  std::vector<Chunk> &chunks, Apart &apart) {
  for (;;) {
    Joined joined = put_together(scene.grid, cell, origin, chunks);
    const std::vector<NodeBox> nodes = spoilers(joined);
    const bool vanished = joined.surface.face.empty() && !chunks.empty() && !apart.whole;
    if (nodes.empty() && !vanished) return std::move(joined.surface);
    apart.whole |= vanished;
    for (const NodeBox &node : nodes)
      apart.add(node);
    for (Chunk &chunk : chunks)
      if (is_met(chunk, apart, nodes)) march_again(scene, index, cell, apart, chunk);
  }
}

} // namespace conceg::mesh
