// SPDX-License-Identifier: BSD-3-Clause
#include "pinch.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::mesh {
namespace {

struct Place {
  std::uint32_t block;
  glm::ivec3 lift; // boxes that bring the place into the box
};

Place place_of(const Grid &grid, const glm::dvec3 &voxel) {
  const glm::ivec3 blocks = grid.blocks();
  Place place = {0, glm::ivec3(0)};
  glm::ivec3 at;
  for (int axis = 0; axis < 3; axis++) {
    int node = static_cast<int>(std::floor(voxel[axis]));
    if (grid.periodic[axis]) place.lift[axis] = -static_cast<int>(std::floor(double(node) / grid.size[axis]));
    node += place.lift[axis] * grid.size[axis] - grid.low[axis];
    at[axis] = std::min(blocks[axis] - 1, std::max(0, node / kBlock));
  }
  place.block = static_cast<std::uint32_t>((at.z * blocks.y + at.y) * blocks.x + at.x);
  return place;
}

class Finder {
public:
  Finder(const Scene &scene, const Index &index) : scene_(scene), index_(index) {
    for (const Cone &cone : scene.cone) { // ends in voxels, so that far cones are left out quickly
      const glm::dvec3 a = glm::dvec3(cone.a) / double(kFixed), b = glm::dvec3(cone.b) / double(kFixed);
      const double half = 0.5 * glm::length((b - a) * glm::dvec3(scene.grid.scale));
      middle_.push_back(0.5 * (a + b));
      reach_.push_back(half + std::max(cone.ra, cone.rb) / double(kFixed));
    }
  }

  // Distance of the nearest other label from a place of `cell`, no farther than `limit` (units).
  double nearest_other(std::uint32_t cell, const glm::dvec3 &voxel, double limit) const {
    const Place place = place_of(scene_.grid, voxel);
    const auto found = std::lower_bound(index_.block.begin(), index_.block.end(), place.block);
    if (found == index_.block.end() || *found != place.block) return limit;
    const auto row = static_cast<std::size_t>(found - index_.block.begin());
    const glm::dvec3 scale(scene_.grid.scale);
    for (std::uint64_t i = index_.offset[row]; i < index_.offset[row + 1]; i++) {
      const IndexEntry &entry = index_.entry[i];
      const glm::ivec3 lift(entry.lift[0], entry.lift[1], entry.lift[2]);
      if (scene_.cone[entry.cone].cell == cell && lift == place.lift) continue;
      const glm::dvec3 moved = voxel + glm::dvec3((place.lift - lift) * scene_.grid.size);
      const double room = limit + reach_[entry.cone];
      const glm::dvec3 off = (moved - middle_[entry.cone]) * scale;
      if (room <= 0 || glm::dot(off, off) > room * room) continue;
      limit = std::min(limit, cone_distance(scene_.grid, scene_.cone[entry.cone], moved));
    }
    return limit;
  }

private:
  const Scene &scene_;
  const Index &index_;
  std::vector<glm::dvec3> middle_;
  std::vector<double> reach_;
};

void look_along(const Scene &scene, const Finder &finder, const Cone &cone, Narrow &narrow) {
  if (cone.kind == kSomaKind) return; // a soma that others cut in two is no matter of thickness
  const glm::dvec3 a = glm::dvec3(cone.a) / double(kFixed), b = glm::dvec3(cone.b) / double(kFixed);
  const double length = glm::length((b - a) * glm::dvec3(scene.grid.scale));
  const int steps = std::max(1, static_cast<int>(std::ceil(length)));
  for (int k = 0; k <= steps; k++) {
    const double t = double(k) / steps, radius = glm::mix(double(cone.ra), double(cone.rb), t) / kFixed;
    const glm::dvec3 voxel = glm::mix(a, b, t);
    // Beyond this the other label leaves enough, whatever it does.
    const double limit = std::max(0.0, 2 * kThinnestTube + scene.gap - radius),
                 other = finder.nearest_other(cone.cell, voxel, limit + radius);
    const double left = std::min(radius, 0.5 * (radius + other - scene.gap));
    if (left >= kThinnestTube) continue;
    if (!narrow.places || left * scene.grid.unit < narrow.least) {
      narrow.least = left * scene.grid.unit;
      narrow.where = scene.grid.origin + voxel * scene.grid.step;
    }
    narrow.places++;
  }
}

} // namespace

std::vector<Narrow> narrow_places(const Scene &scene, const Index &index, Workers &workers) {
  const Finder finder(scene, index);
  std::vector<std::size_t> first(scene.cells + 1, scene.cone.size()); // cones are sorted by cell
  for (std::size_t i = scene.cone.size(); i-- > 0;)
    first[scene.cone[i].cell] = i;
  for (std::size_t cell = scene.cells; cell-- > 0;)
    first[cell] = std::min(first[cell], first[cell + 1]);
  std::vector<Narrow> narrow(scene.cells);
  workers.loop(scene.cells, 1, [&](std::size_t cell, unsigned) {
    for (std::size_t i = first[cell]; i < first[cell + 1]; i++)
      look_along(scene, finder, scene.cone[i], narrow[cell]);
  });
  return narrow;
}

} // namespace conceg::mesh
