// SPDX-License-Identifier: BSD-3-Clause
#include "field.hpp"
#include "wide.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace conceg::mesh {
namespace {

// A cone with what its distance needs, in units, relative to point a.
struct Shape {
  glm::dvec3 axis;                     // unit vector a -> b, zero for a ball
  double length, inverse_length, tilt; // tilt = s / sqrt(1 - s^2), s = (rb - ra) / length
  double ra, slope;                    // slope = rb - ra
  glm::ivec3 a;                        // fixed point
};

Shape shape_of(const Grid &grid, const Cone &cone) {
  Shape shape = {};
  const glm::dvec3 along = glm::dvec3(cone.b - cone.a) * (1.0 / kFixed) * glm::dvec3(grid.scale);
  const double length = glm::length(along), slope = (cone.rb - cone.ra) / double(kFixed);
  shape.a = cone.a;
  shape.ra = cone.ra / double(kFixed);
  if (length <= std::fabs(slope)) { // one ball holds the other
    if (cone.rb > cone.ra) shape.a = cone.b, shape.ra = cone.rb / double(kFixed);
    return shape;
  }
  const double s = slope / length;
  shape.axis = along / length;
  shape.length = length, shape.inverse_length = 1.0 / length;
  shape.tilt = s / std::sqrt(1.0 - s * s);
  shape.slope = slope;
  return shape;
}

double shape_distance(const Shape &shape, const glm::dvec3 &from_a) {
  const double along = glm::dot(from_a, shape.axis);
  const glm::dvec3 across = from_a - along * shape.axis;
  const double across2 = glm::dot(across, across);
  const double t =
      std::min(1.0, std::max(0.0, (along + std::sqrt(across2) * shape.tilt) * shape.inverse_length));
  const double rest = along - t * shape.length;
  return std::sqrt(across2 + rest * rest) - (shape.ra + t * shape.slope);
}

// ---- Index ----

struct AxisImage {
  int lift, first, last; // blocks first .. last see the cone moved by lift boxes
};

void axis_images(const Grid &grid, int axis, double low, double high, std::vector<AxisImage> &out) {
  out.clear();
  const int blocks = grid.blocks()[axis], size = grid.size[axis];
  int lift0 = 0, lift1 = 0;
  if (grid.periodic[axis]) {
    lift0 = static_cast<int>(std::ceil((-kHalo - high) / size));
    lift1 = static_cast<int>(std::floor((size + kHalo - low) / size));
  }
  for (int lift = lift0; lift <= lift1; lift++) {
    const double from = low + double(lift) * size - grid.low[axis],
                 to = high + double(lift) * size - grid.low[axis];
    const int first = std::max(0, static_cast<int>(std::ceil((from - kBlock - kHalo) / kBlock)));
    const int last = std::min(blocks - 1, static_cast<int>(std::floor((to + kHalo) / kBlock)));
    if (first <= last) out.push_back({lift, first, last});
  }
}

// False when no node of the block can be within reach: distance at the centre less half the diagonal.
bool block_feels(const Scene &scene, const Shape &shape, float reach, const glm::ivec3 &block,
                 const glm::ivec3 &lift) {
  const Grid &grid = scene.grid;
  const glm::dvec3 centre = glm::dvec3(grid.low + block * kBlock - lift * grid.size) + 0.5 * kBlock;
  const glm::dvec3 scale(grid.scale);
  const double diagonal = (0.5 * kBlock + kHalo) * glm::length(scale);
  return shape_distance(shape, (centre - glm::dvec3(shape.a) / double(kFixed)) * scale) - diagonal <
         reach + 0.01;
}

struct BlockEntry {
  std::uint32_t block;
  IndexEntry entry;
};

void index_cone(const Scene &scene, std::uint32_t number, std::vector<BlockEntry> &out) {
  const Grid &grid = scene.grid;
  const Cone &cone = scene.cone[number];
  const float reach = scene.section[cone.section].reach;
  const double margin = std::max(cone.ra, cone.rb) / double(kFixed) + reach + 0.01;
  const Shape shape = shape_of(grid, cone);
  std::array<std::vector<AxisImage>, 3> images;
  for (int axis = 0; axis < 3; axis++)
    axis_images(grid, axis, std::min(cone.a[axis], cone.b[axis]) / double(kFixed) - margin,
                std::max(cone.a[axis], cone.b[axis]) / double(kFixed) + margin, images[axis]);
  const glm::ivec3 blocks = grid.blocks();
  for (const AxisImage &iz : images[2])
    for (const AxisImage &iy : images[1])
      for (const AxisImage &ix : images[0]) {
        const glm::ivec3 lift(ix.lift, iy.lift, iz.lift);
        for (int z = iz.first; z <= iz.last; z++)
          for (int y = iy.first; y <= iy.last; y++)
            for (int x = ix.first; x <= ix.last; x++)
              if (block_feels(scene, shape, reach, {x, y, z}, lift))
                out.push_back({static_cast<std::uint32_t>((z * blocks.y + y) * blocks.x + x),
                               {number,
                                {static_cast<std::int16_t>(lift.x), static_cast<std::int16_t>(lift.y),
                                 static_cast<std::int16_t>(lift.z)}}});
      }
}

// ---- Evaluation of one block ----

// A cone in a block: single precision, relative to the block's first node. The differences to nodes are
// exact.
struct LocalCone {
  float a[3], axis[3], length, inverse_length, tilt, ra, slope, reach;
  int low[3], high[3]; // local nodes that can be within reach
};

LocalCone local_cone(const Scene &scene, const IndexEntry &entry, const glm::ivec3 &first) {
  const Grid &grid = scene.grid;
  const Cone &cone = scene.cone[entry.cone];
  const Shape shape = shape_of(grid, cone);
  LocalCone local = {};
  local.reach = scene.section[cone.section].reach;
  const double margin = std::max(cone.ra, cone.rb) / double(kFixed) + local.reach + 0.01;
  for (int axis = 0; axis < 3; axis++) {
    const int shift = (entry.lift[axis] * grid.size[axis] - first[axis]) * kFixed;
    local.a[axis] = static_cast<float>(shape.a[axis] + shift) * (1.0f / kFixed);
    local.axis[axis] = static_cast<float>(shape.axis[axis]);
    const double low =
        (std::min(cone.a[axis], cone.b[axis]) + shift) / double(kFixed) - margin / grid.scale[axis];
    const double high =
        (std::max(cone.a[axis], cone.b[axis]) + shift) / double(kFixed) + margin / grid.scale[axis];
    local.low[axis] = std::max(0, static_cast<int>(std::ceil(low)));
    local.high[axis] = std::min(kRow - 1, static_cast<int>(std::floor(high)));
  }
  local.length = static_cast<float>(shape.length),
  local.inverse_length = static_cast<float>(shape.inverse_length);
  local.tilt = static_cast<float>(shape.tilt);
  local.ra = static_cast<float>(shape.ra), local.slope = static_cast<float>(shape.slope);
  return local;
}

// Minimum of a row of nodes with the distances to one cone. One code path for every row: same bits
// everywhere.
inline void cone_row(float *value, const LocalCone &cone, const glm::vec3 &scale, float dy, float dz) {
  const float ux = cone.axis[0], uy = cone.axis[1], uz = cone.axis[2], ax = cone.a[0], sx = scale.x;
  const float row_along = dy * uy + dz * uz;
  for (int x = cone.low[0]; x <= cone.high[0]; x++) {
    const float dx = (static_cast<float>(x) - ax) * sx;
    const float along = dx * ux + row_along;
    const float wx = dx - along * ux, wy = dy - along * uy, wz = dz - along * uz;
    const float across2 = wx * wx + wy * wy + wz * wz;
    float t = (along + std::sqrt(across2) * cone.tilt) * cone.inverse_length;
    t = t > 0.0f ? t : 0.0f;
    t = t < 1.0f ? t : 1.0f;
    const float rest = along - t * cone.length;
    float distance = std::sqrt(across2 + rest * rest) - (cone.ra + t * cone.slope);
    distance = distance < cone.reach ? distance : kFar;
    value[x] = distance < value[x] ? distance : value[x];
  }
}

WIDE void add_cone(float *value, const LocalCone &cone, const glm::vec3 &scale) {
  for (int z = cone.low[2]; z <= cone.high[2]; z++)
    for (int y = cone.low[1]; y <= cone.high[1]; y++)
      cone_row(value + (z * kRow + y) * kRow, cone, scale, (static_cast<float>(y) - cone.a[1]) * scale.y,
               (static_cast<float>(z) - cone.a[2]) * scale.z);
}

// Polynomial smooth minimum of two sections; far values stay far.
WIDE void blend(float *union_value, const float *section_value, float k) {
  const float quarter = k > 0.0f ? 0.25f / k : 0.0f;
  for (int i = 0; i < kNodes; i++) {
    const float a = union_value[i], b = section_value[i];
    const float close = k - std::fabs(a - b);
    const float overlap = close > 0.0f ? close : 0.0f;
    union_value[i] = (a < b ? a : b) - overlap * overlap * quarter;
  }
}

bool same_label(const Scene &scene, const IndexEntry &l, const IndexEntry &r) {
  return scene.cone[l.cone].cell == scene.cone[r.cone].cell && std::equal(l.lift, l.lift + 3, r.lift);
}

void evaluate_labels(const Scene &scene, const Index &index, std::size_t row, BlockField &out) {
  static thread_local std::vector<float> section_value;
  section_value.resize(kNodes);
  std::uint64_t i = index.offset[row];
  const std::uint64_t end = index.offset[row + 1];
  while (i < end) {
    const IndexEntry &head = index.entry[i];
    out.label.push_back({scene.cone[head.cone].cell, {head.lift[0], head.lift[1], head.lift[2]}});
    out.value.resize(out.label.size() * kNodes);
    float *value = out.of(out.label.size() - 1);
    bool first_section = true;
    while (i < end && same_label(scene, head, index.entry[i])) {
      const std::uint32_t section = scene.cone[index.entry[i].cone].section;
      float *target = first_section ? value : section_value.data();
      std::fill(target, target + kNodes, kFar);
      for (; i < end && same_label(scene, head, index.entry[i]) &&
             scene.cone[index.entry[i].cone].section == section;
           i++)
        add_cone(target, local_cone(scene, index.entry[i], out.first), scene.grid.scale);
      if (!first_section) blend(value, target, scene.section[section].blend);
      first_section = false;
    }
  }
}

// phi_i' = max(psi_i, (psi_i - m_i)/2 + g/2), m_i the smallest value of the others; then small values snap
// upwards.
WIDE void separate(BlockField &field, float gap, float snap) {
  field.nearest.assign(kNodes, kFar);
  field.second.assign(kNodes, kFar);
  field.owner.assign(kNodes, 0);
  float *nearest = field.nearest.data(), *second = field.second.data();
  std::uint32_t *owner = field.owner.data();
  const float half_gap = 0.5f * gap;
  for (std::size_t label = 0; label < field.label.size(); label++) {
    const float *value = field.of(label);
    for (int i = 0; i < kNodes; i++) {
      const float v = value[i], larger = v > nearest[i] ? v : nearest[i];
      second[i] = larger < second[i] ? larger : second[i];
      owner[i] = v < nearest[i] ? static_cast<std::uint32_t>(label) : owner[i];
      nearest[i] = v < nearest[i] ? v : nearest[i];
    }
  }
  for (std::size_t label = 0; label < field.label.size(); label++) {
    float *value = field.of(label);
    for (int i = 0; i < kNodes; i++) {
      const float v = value[i], other = owner[i] == label ? second[i] : nearest[i];
      const float split = 0.5f * (v - other) + half_gap;
      const float apart = split > v ? split : v;
      value[i] = apart < snap && apart > -snap ? snap : apart;
    }
  }
}

} // namespace

double cone_distance(const Grid &grid, const Cone &cone, const glm::dvec3 &voxel) {
  const Shape shape = shape_of(grid, cone);
  return shape_distance(shape, (voxel - glm::dvec3(shape.a) / double(kFixed)) * glm::dvec3(grid.scale));
}

double cone_distance_below(const Grid &grid, const Cone &cone, const glm::dvec3 &voxel, double most) {
  const glm::dvec3 scale = glm::dvec3(grid.scale) * (1.0 / kFixed);
  const glm::dvec3 along = glm::dvec3(cone.b - cone.a) * scale,
                   from_a = voxel * glm::dvec3(grid.scale) - glm::dvec3(cone.a) * scale;
  const double length2 = glm::dot(along, along), way = glm::dot(from_a, along);
  const double t = way <= 0 ? 0 : way >= length2 ? 1 : way / length2;
  const glm::dvec3 across = from_a - t * along;
  const double reach = most + std::max(cone.ra, cone.rb) * (1.0 / kFixed);
  if (reach < 0 || glm::dot(across, across) > reach * reach * (1 + 1e-9)) return most;
  return std::min(most, cone_distance(grid, cone, voxel));
}

Index make_index(const Scene &scene, Workers &workers, const Progress &progress) {
  constexpr std::size_t kBatch = 4096;
  std::vector<std::vector<BlockEntry>> parts((scene.cone.size() + kBatch - 1) / kBatch);
  workers.loop(parts.size(), 1, [&](std::size_t part, unsigned) {
    for (std::size_t i = part * kBatch; i < std::min(scene.cone.size(), (part + 1) * kBatch); i++)
      index_cone(scene, static_cast<std::uint32_t>(i), parts[part]);
  });
  report(progress, "mesh: index", 1, 2);
  const glm::ivec3 blocks = scene.grid.blocks();
  const std::size_t places = static_cast<std::size_t>(blocks.x) * static_cast<std::size_t>(blocks.y) *
                             static_cast<std::size_t>(blocks.z);
  std::vector<std::uint64_t> start(places + 1);
  for (const auto &part : parts)
    for (const BlockEntry &e : part)
      start[e.block + 1]++;
  std::partial_sum(start.begin(), start.end(), start.begin());
  Index index;
  for (std::size_t block = 0; block < places; block++)
    if (start[block] != start[block + 1])
      index.block.push_back(static_cast<std::uint32_t>(block)), index.offset.push_back(start[block]);
  index.offset.push_back(start[places]);
  index.entry.resize(start[places]);
  for (auto &part : parts) {
    for (const BlockEntry &e : part)
      index.entry[start[e.block]++] = e.entry;
    part = {};
  }
  const auto key = [&](const IndexEntry &e) {
    return std::make_tuple(scene.cone[e.cone].cell, e.lift[2], e.lift[1], e.lift[0], e.cone);
  };
  workers.loop(index.block.size(), 16, [&](std::size_t row, unsigned) {
    std::sort(index.entry.begin() + static_cast<std::ptrdiff_t>(index.offset[row]),
              index.entry.begin() + static_cast<std::ptrdiff_t>(index.offset[row + 1]),
              [&](const IndexEntry &l, const IndexEntry &r) { return key(l) < key(r); });
  });
  return index;
}

void evaluate_block(const Scene &scene, const Index &index, std::size_t row, BlockField &out) {
  const Grid &grid = scene.grid;
  const glm::ivec3 blocks = grid.blocks();
  const int block = static_cast<int>(index.block[row]);
  const glm::ivec3 at(block % blocks.x, block / blocks.x % blocks.y, block / (blocks.x * blocks.y));
  out.first = grid.low + at * kBlock - kHalo;
  out.cubes = glm::min(glm::ivec3(kBlock), grid.high - (out.first + kHalo));
  out.label.clear();
  out.value.clear();
  evaluate_labels(scene, index, row, out);
  separate(out, static_cast<float>(scene.gap), scene.snap);
}

Place place_of(const Grid &grid, const Index &index, const glm::dvec3 &voxel) {
  const glm::ivec3 blocks = grid.blocks();
  Place place;
  glm::ivec3 at;
  for (int axis = 0; axis < 3; axis++) {
    int node = static_cast<int>(std::floor(voxel[axis]));
    if (grid.periodic[axis]) place.lift[axis] = -static_cast<int>(std::floor(double(node) / grid.size[axis]));
    node += place.lift[axis] * grid.size[axis] - grid.low[axis];
    at[axis] = std::min(blocks[axis] - 1, std::max(0, node / kBlock));
  }
  const auto block = static_cast<std::uint32_t>((at.z * blocks.y + at.y) * blocks.x + at.x);
  const auto found = std::lower_bound(index.block.begin(), index.block.end(), block);
  if (found != index.block.end() && *found == block) place.row = found - index.block.begin();
  return place;
}

std::int64_t nearest_cone(const Scene &scene, const Index &index, std::uint32_t cell,
                          const glm::dvec3 &voxel) {
  const Grid &grid = scene.grid;
  const auto [at, lift] = place_of(grid, index, voxel);
  if (at < 0) return -1;
  const auto row = static_cast<std::size_t>(at);
  const auto first = index.entry.begin() + static_cast<std::ptrdiff_t>(index.offset[row]);
  const auto last = index.entry.begin() + static_cast<std::ptrdiff_t>(index.offset[row + 1]);
  const auto key = [&](const IndexEntry &e) {
    return std::make_tuple(scene.cone[e.cone].cell, e.lift[2], e.lift[1], e.lift[0]);
  };
  const auto wanted = std::make_tuple(cell, static_cast<std::int16_t>(lift.z),
                                      static_cast<std::int16_t>(lift.y), static_cast<std::int16_t>(lift.x));
  std::int64_t best = -1;
  double least = 1e300;
  for (auto it = std::lower_bound(first, last, wanted,
                                  [&](const IndexEntry &e, const auto &w) { return key(e) < w; });
       it != last && key(*it) == wanted; ++it) {
    const double distance = cone_distance_below(grid, scene.cone[it->cone], voxel, least);
    if (distance < least) best = it->cone, least = distance;
  }
  return best;
}

} // namespace conceg::mesh
