// SPDX-License-Identifier: GPL-3.0-or-later
#include "tiles.hpp"

#include "guard.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::triangulate {
namespace {

// Where bucket `index` of the endless row of copies comes from: the bucket, how many sides away, and whether
// reflected.
struct Origin {
  std::int64_t bucket, sides;
  bool reflected;
};

Origin origin_of(std::int64_t index, std::int64_t count, bool periodic) {
  const std::int64_t sides = index >= 0 ? index / count : -((count - 1 - index) / count);
  const std::int64_t within = index - sides * count;
  if (periodic || sides % 2 == 0) return {within, sides, false};
  return {count - 1 - within, sides, true};
}

double copied(const conceg_box &box, int axis, double x, const Origin &origin) {
  const double side = conceg_box_side(&box, axis);
  const double away = side * static_cast<double>(origin.sides);
  return origin.reflected ? box.lo[axis] + away + (box.hi[axis] - x) : x + away;
}

} // namespace

Buckets::Buckets(const conceg_box &box, const std::vector<glm::dvec3> &nodes, double bucket_um)
    : box_(box), nodes_(nodes) {
  std::uint64_t total = 1;
  for (int axis = 0; axis < 3; axis++) {
    const double side = conceg_box_side(&box, axis);
    count_[axis] = std::max<std::int64_t>(1, static_cast<std::int64_t>(side / bucket_um));
    width_[axis] = side / static_cast<double>(count_[axis]);
    total *= static_cast<std::uint64_t>(count_[axis]);
  }
  const auto bucket_of = [&](const glm::dvec3 &p) {
    std::uint64_t index = 0;
    for (int axis = 0; axis < 3; axis++) {
      const auto at = static_cast<std::int64_t>((p[axis] - box_.lo[axis]) / width_[axis]);
      index = index * static_cast<std::uint64_t>(count_[axis]) +
              static_cast<std::uint64_t>(std::clamp<std::int64_t>(at, 0, count_[axis] - 1));
    }
    return index;
  };
  offset_.assign(total + 1, 0);
  for (const glm::dvec3 &p : nodes)
    offset_[bucket_of(p) + 1]++;
  for (std::size_t i = 0; i < total; i++)
    offset_[i + 1] += offset_[i];
  std::vector<std::uint64_t> next(offset_.begin(), offset_.end() - 1);
  node_.resize(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); i++)
    node_[next[bucket_of(nodes[i])]++] = static_cast<std::uint32_t>(i);
}

double Buckets::edge(int axis, std::int64_t bucket) const {
  return bucket == count_[axis] ? box_.hi[axis] : box_.lo[axis] + width_[axis] * static_cast<double>(bucket);
}

std::uint64_t Buckets::nodes_within(const std::array<std::int64_t, 3> &first,
                                    const std::array<std::int64_t, 3> &last) const {
  std::uint64_t nodes = 0;
  for (std::int64_t x = first[0]; x < last[0]; x++)
    for (std::int64_t y = first[1]; y < last[1]; y++) {
      const auto row =
          static_cast<std::size_t>((x * count_[1] + y) * count_[2]); // along z they follow one another
      nodes += offset_[row + static_cast<std::size_t>(last[2])] -
               offset_[row + static_cast<std::size_t>(first[2])];
    }
  return nodes;
}

namespace {

// Adds the tile, or its halves when it is too full and has buckets left to share.
void add_halved(const Buckets &buckets, const Tile &tile, std::uint64_t most_nodes,
                std::vector<Tile> &tiles) {
  int longest = 0;
  const auto length = [&](int axis) {
    return buckets.edge(axis, tile.last[axis]) - buckets.edge(axis, tile.first[axis]);
  };
  for (int axis = 1; axis < 3; axis++)
    if (length(axis) > length(longest)) longest = axis;
  const std::int64_t middle = (tile.first[longest] + tile.last[longest]) / 2;
  if (middle == tile.first[longest] || buckets.nodes_within(tile.first, tile.last) <= most_nodes) {
    tiles.push_back(tile);
    return;
  }
  Tile lower = tile, upper = tile;
  lower.last[longest] = upper.first[longest] = middle;
  add_halved(buckets, lower, most_nodes, tiles);
  add_halved(buckets, upper, most_nodes, tiles);
}

} // namespace

std::vector<Tile> cut_tiles(const Buckets &buckets, double tile_um, std::size_t least,
                            std::uint64_t most_nodes) {
  std::array<std::int64_t, 3> parts;
  for (int axis = 0; axis < 3; axis++) {
    const double side = conceg_box_side(&buckets.box(), axis);
    parts[axis] = std::min(buckets.count(axis), static_cast<std::int64_t>(std::ceil(side / tile_um)));
  }
  const auto total = [&] { return static_cast<std::size_t>(parts[0] * parts[1] * parts[2]); };
  while (total() < least) {
    int longest = -1; // the axis with the longest tile side that can still be halved
    double length = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      const double tile = conceg_box_side(&buckets.box(), axis) / static_cast<double>(parts[axis]);
      if (2 * parts[axis] <= buckets.count(axis) && tile > length) longest = axis, length = tile;
    }
    if (longest < 0) break;
    parts[longest] *= 2;
  }
  std::vector<Tile> tiles;
  tiles.reserve(total());
  std::array<std::int64_t, 3> at;
  for (at[0] = 0; at[0] < parts[0]; at[0]++)
    for (at[1] = 0; at[1] < parts[1]; at[1]++)
      for (at[2] = 0; at[2] < parts[2]; at[2]++) {
        Tile tile;
        for (int axis = 0; axis < 3; axis++) {
          tile.first[axis] = buckets.count(axis) * at[axis] / parts[axis];
          tile.last[axis] = buckets.count(axis) * (at[axis] + 1) / parts[axis];
        }
        add_halved(buckets, tile, most_nodes, tiles);
      }
  return tiles;
}

Region region_of(const Buckets &buckets, const Tile &tile, double halo_um) {
  Region region;
  for (int axis = 0; axis < 3; axis++) {
    region.lo[axis] = buckets.edge(axis, tile.first[axis]) - halo_um;
    region.hi[axis] = buckets.edge(axis, tile.last[axis]) + halo_um;
  }
  return region;
}

// Walks over the buckets that the region meets and collects copies.
struct Gather {
  const Buckets &buckets;
  const Tile &tile;
  const double halo_um;
  const Region region;
  std::vector<Copy> core, halo;

  void run() {
    std::array<std::vector<Origin>, 3> origins;
    for (int axis = 0; axis < 3; axis++) {
      const double width = buckets.width_[axis], lo = buckets.box_.lo[axis];
      const auto first = static_cast<std::int64_t>(std::floor((region.lo[axis] - lo) / width)) - 1;
      const auto last = static_cast<std::int64_t>(std::floor((region.hi[axis] - lo) / width)) + 1;
      for (std::int64_t i = first; i <= last; i++)
        origins[axis].push_back(origin_of(i, buckets.count_[axis], buckets.box_.periodic[axis] != 0));
    }
    for (const Origin &x : origins[0])
      for (const Origin &y : origins[1])
        for (const Origin &z : origins[2])
          bucket({x, y, z});
  }

  void bucket(const std::array<Origin, 3> &origin) {
    bool ghost = false, core_bucket = true;
    std::uint64_t index = 0;
    for (int axis = 0; axis < 3; axis++) {
      const Origin &o = origin[axis];
      if (o.sides < -127 || o.sides > 127)
        fail(CONCEG_E_RANGE,
             "/domain: expected a side of more than 1/100 of the halo of %g um on axis %d, got %g um; ask "
             "for a larger box or a higher density_per_um3",
             halo_um, axis, conceg_box_side(&buckets.box_, axis));
      ghost = ghost || (!buckets.box_.periodic[axis] && o.sides != 0);
      core_bucket = core_bucket && o.sides == 0 && o.bucket >= tile.first[axis] && o.bucket < tile.last[axis];
      index = index * static_cast<std::uint64_t>(buckets.count_[axis]) + static_cast<std::uint64_t>(o.bucket);
    }
    for (std::uint64_t i = buckets.offset_[index]; i < buckets.offset_[index + 1]; i++) {
      const std::uint32_t node = buckets.node_[i];
      Copy copy{{}, ghost ? kGhost : node, {}, core_bucket};
      bool in_region = true, on_mirror = false;
      for (int axis = 0; axis < 3; axis++) {
        const double x = buckets.nodes_[node][axis];
        copy.position[axis] = copied(buckets.box_, axis, x, origin[axis]);
        copy.shift[axis] = static_cast<std::int8_t>(origin[axis].sides);
        in_region =
            in_region && copy.position[axis] >= region.lo[axis] && copy.position[axis] <= region.hi[axis];
        on_mirror = on_mirror || (origin[axis].reflected && copy.position[axis] == x); // its own reflection
      }
      if (core_bucket)
        core.push_back(copy);
      else if (in_region && !on_mirror)
        halo.push_back(copy);
    }
  }
};

std::vector<Copy> gather_copies(const Buckets &buckets, const Tile &tile, double halo_um) {
  Gather gather{buckets, tile, halo_um, region_of(buckets, tile, halo_um), {}, {}};
  gather.run();
  std::sort(gather.core.begin(), gather.core.end(),
            [](const Copy &a, const Copy &b) { return a.node < b.node; });
  std::vector<Copy> copies = std::move(gather.core);
  copies.insert(copies.end(), gather.halo.begin(), gather.halo.end());
  return copies;
}

std::vector<Copy> gather_mirrored(const conceg_box &box, const std::vector<glm::dvec3> &nodes) {
  std::vector<Copy> copies, twins;
  copies.reserve(nodes.size());
  for (std::size_t node = 0; node < nodes.size(); node++)
    for (unsigned upper = 0; upper < 8; upper++) {
      Copy copy{nodes[node], static_cast<std::uint32_t>(node), {}, true};
      bool exists = true;
      for (int axis = 0; axis < 3; axis++)
        if (upper >> axis & 1) {
          exists = exists && box.periodic[axis] && nodes[node][axis] == box.lo[axis];
          copy.position[axis] = box.hi[axis];
          copy.shift[axis] = 1;
        }
      if (exists) (upper == 0 ? copies : twins).push_back(copy);
    }
  copies.insert(copies.end(), twins.begin(), twins.end());
  return copies;
}

} // namespace conceg::triangulate
