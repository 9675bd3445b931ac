// SPDX-License-Identifier: BSD-3-Clause
#include "field.hpp"

#include "tile.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace conceg::analyse {

namespace {

constexpr int block_side = 16;

// A round cone (a == b: a ball), ready for many distances: all of it relative to a.
struct Cone {
  glm::dvec3 a, b, axis; // axis of length 1
  double length, radius_a, radius_b, lean;
  bool soma;
};

Cone make_cone(const glm::dvec3 &a, const glm::dvec3 &b, double radius_a, double radius_b, bool soma) {
  const double length = glm::distance(a, b), change = radius_b - radius_a;
  if (length <= std::abs(change) || length <= 0) { // one end ball holds the other
    const glm::dvec3 centre = change > 0 ? b : a;
    const double radius = std::max(radius_a, radius_b);
    return {centre, centre, glm::dvec3(1, 0, 0), 0, radius, radius, 0, soma};
  }
  const double slope = change / length;
  return {a, b, (b - a) / length, length, radius_a, radius_b, slope / std::sqrt(1 - slope * slope), soma};
}

// t = clamp((X + Y s / sqrt(1 - s^2)) / l, 0, 1); phi = sqrt(Y^2 + (X - t l)^2) - (ra + t (rb - ra))
bool inside(const Cone &cone, const glm::dvec3 &p) {
  const glm::dvec3 from = p - cone.a;
  const double x = glm::dot(from, cone.axis), y2 = std::max(0.0, glm::dot(from, from) - x * x);
  const double along =
      cone.length > 0 ? std::min(std::max(x + std::sqrt(y2) * cone.lean, 0.0), cone.length) : 0;
  const double radius = cone.length > 0
                            ? cone.radius_a + (cone.radius_b - cone.radius_a) * (along / cone.length)
                            : cone.radius_a;
  return y2 + (x - along) * (x - along) < radius * radius;
}

std::vector<Cone> cones_of(const Cells &cells, const Skeletons &s) {
  std::vector<Cone> cones;
  for (std::size_t cell = 0; cell < cells.type.size(); cell++) {
    const double soma_radius = cells.soma_radius[cell];
    if (soma_radius > 0)
      cones.push_back(make_cone(cells.soma[cell], cells.soma[cell], soma_radius, soma_radius, true));
    if (s.cell_offset.empty()) continue;
    for (std::size_t i = s.cell_offset[cell]; i < s.cell_offset[cell + 1]; i++) {
      const double radius = s.radius[i];
      if (s.parent[i] >= 0) {
        const std::size_t parent = s.cell_offset[cell] + static_cast<std::size_t>(s.parent[i]);
        cones.push_back(make_cone(s.position[parent], s.position[i], s.radius[parent], radius, false));
        continue;
      }
      // A root is joined to its soma by a stub from one radius below the soma's surface.
      const glm::dvec3 inward = cells.soma[cell] - s.position[i];
      const double distance = glm::length(inward);
      glm::dvec3 start = s.position[i];
      if (soma_radius > 0 && distance > 0)
        start += inward * (std::min(distance, std::max(radius, distance - soma_radius + radius)) / distance);
      cones.push_back(make_cone(start, s.position[i], radius, radius, false));
    }
  }
  return cones;
}

struct Grid {
  glm::dvec3 lo, step;
  glm::ivec3 voxels, blocks;
};

Grid make_grid(const conceg_box &box, double step) {
  Grid grid;
  double count = 1;
  for (int a = 0; a < 3; a++) {
    const double voxels = std::ceil(conceg_box_side(&box, a) / step);
    count *= voxels;
    if (!(count < 1e11))
      fail(CONCEG_E_RANGE, "analyse.field_step_um: %g um makes more than 1e11 voxels; raise it", step);
    grid.lo[a] = box.lo[a];
    grid.step[a] = conceg_box_side(&box, a) / voxels;
    grid.voxels[a] = static_cast<int>(voxels);
    grid.blocks[a] = (grid.voxels[a] + block_side - 1) / block_side;
  }
  return grid;
}

struct Placed {
  std::uint32_t cone;
  glm::ivec3 lift, first, last; // voxels whose centres can be inside
};

std::vector<Placed> place(const std::vector<Cone> &cones, const conceg_box &box, const Grid &grid) {
  std::vector<Placed> placed;
  const glm::dvec3 sides = side(box);
  for (std::uint32_t c = 0; c < cones.size(); c++) {
    const double radius = std::max(cones[c].radius_a, cones[c].radius_b);
    const glm::dvec3 low = glm::min(cones[c].a, cones[c].b) - radius,
                     high = glm::max(cones[c].a, cones[c].b) + radius;
    for_each_lift(box, low, high, [&](const glm::ivec3 &lift) {
      Placed p = {c, lift, glm::ivec3(0), glm::ivec3(0)};
      const glm::dvec3 shift = sides * glm::dvec3(lift);
      for (int a = 0; a < 3; a++) {
        const double from = std::ceil((low[a] + shift[a] - grid.lo[a]) / grid.step[a] - 0.5);
        const double to = std::floor((high[a] + shift[a] - grid.lo[a]) / grid.step[a] - 0.5);
        if (to < 0 || from > grid.voxels[a] - 1) return;
        p.first[a] = static_cast<int>(std::max(0.0, from));
        p.last[a] = static_cast<int>(std::min<double>(grid.voxels[a] - 1, to));
        if (p.last[a] < p.first[a]) return;
      }
      placed.push_back(p);
    });
  }
  return placed;
}

// CSR: the placed cones of each block, in the order of `placed`.
struct BlockIndex {
  std::vector<std::uint64_t> offset;
  std::vector<std::uint32_t> entry;
};

template <class Body> void for_each_block(const Grid &grid, const Placed &p, Body &&body) {
  for (int x = p.first.x / block_side; x <= p.last.x / block_side; x++)
    for (int y = p.first.y / block_side; y <= p.last.y / block_side; y++)
      for (int z = p.first.z / block_side; z <= p.last.z / block_side; z++)
        body((static_cast<std::size_t>(x) * static_cast<std::size_t>(grid.blocks.y) +
              static_cast<std::size_t>(y)) *
                 static_cast<std::size_t>(grid.blocks.z) +
             static_cast<std::size_t>(z));
}

BlockIndex index_blocks(const Grid &grid, const std::vector<Placed> &placed) {
  const std::size_t blocks = static_cast<std::size_t>(grid.blocks.x) *
                             static_cast<std::size_t>(grid.blocks.y) *
                             static_cast<std::size_t>(grid.blocks.z);
  BlockIndex index;
  index.offset.assign(blocks + 1, 0);
  for (const Placed &p : placed)
    for_each_block(grid, p, [&](std::size_t b) { index.offset[b + 1]++; });
  for (std::size_t b = 0; b < blocks; b++)
    index.offset[b + 1] += index.offset[b];
  index.entry.resize(index.offset.back());
  std::vector<std::uint64_t> next(index.offset.begin(), index.offset.end() - 1);
  for (std::uint32_t i = 0; i < placed.size(); i++)
    for_each_block(grid, placed[i], [&](std::size_t b) { index.entry[next[b]++] = i; });
  return index;
}

enum Voxel : std::uint8_t { outside = 0, in_neurite = 1, in_soma = 2 };

// Marks the voxels of one block that lie inside one cone.
void mark(const Grid &grid, const glm::dvec3 &shift, const Cone &cone, const Placed &p,
          const glm::ivec3 &corner, std::uint8_t *voxel) {
  const glm::ivec3 first = glm::max(p.first, corner), last = glm::min(p.last, corner + (block_side - 1));
  const std::uint8_t value = cone.soma ? in_soma : in_neurite;
  for (int x = first.x; x <= last.x; x++)
    for (int y = first.y; y <= last.y; y++)
      for (int z = first.z; z <= last.z; z++) {
        std::uint8_t &at =
            voxel[((x - corner.x) * block_side + (y - corner.y)) * block_side + (z - corner.z)];
        if (at >= value) continue;
        if (inside(cone, grid.lo + (glm::dvec3(x, y, z) + 0.5) * grid.step - shift)) at = value;
      }
}

} // namespace

FieldShares field_shares(const Cells &cells, const Skeletons &skeletons, const conceg_box &box, double step,
                         Workers &workers, const Progress &progress) {
  const std::vector<Cone> cones = cones_of(cells, skeletons);
  const Grid grid = make_grid(box, step);
  const std::vector<Placed> placed = place(cones, box, grid);
  const BlockIndex index = index_blocks(grid, placed);
  const std::size_t blocks = index.offset.size() - 1, batch = 4096;
  const glm::dvec3 sides = side(box);
  std::vector<std::array<std::uint32_t, 3>> counts(blocks, {0, 0, 0});
  for (std::size_t start = 0; start < blocks; start += batch) {
    report(progress, "analyse: field", start, blocks);
    workers.loop(std::min(batch, blocks - start), 16, [&](std::size_t n, unsigned) {
      const std::size_t b = start + n;
      const auto by = static_cast<std::size_t>(grid.blocks.y), bz = static_cast<std::size_t>(grid.blocks.z);
      const glm::ivec3 corner = block_side * glm::ivec3(b / (by * bz), b / bz % by, b % bz);
      std::array<std::uint8_t, block_side * block_side * block_side> voxel{};
      for (std::uint64_t i = index.offset[b]; i < index.offset[b + 1]; i++) {
        const Placed &p = placed[index.entry[i]];
        mark(grid, sides * glm::dvec3(p.lift), cones[p.cone], p, corner, voxel.data());
      }
      for (const std::uint8_t v : voxel)
        counts[b][v]++;
    });
  }
  std::array<std::uint64_t, 3> sum = {0, 0, 0};
  for (const auto &c : counts)
    for (std::size_t v = 0; v < 3; v++)
      sum[v] += c[v];
  FieldShares shares;
  shares.voxels = static_cast<std::uint64_t>(grid.voxels.x) * static_cast<std::uint64_t>(grid.voxels.y) *
                  static_cast<std::uint64_t>(grid.voxels.z);
  shares.soma = static_cast<double>(sum[in_soma]) / static_cast<double>(shares.voxels);
  shares.neurite = static_cast<double>(sum[in_neurite]) / static_cast<double>(shares.voxels);
  return shares;
}

} // namespace conceg::analyse
