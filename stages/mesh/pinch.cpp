// SPDX-License-Identifier: BSD-3-Clause
#include "pinch.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::mesh {
namespace {

// Distance from a point of a cone's axis to the nearest other label, in units; at most `most`.
double nearest_other(const Scene &scene, const Index &index, const Cone &cone, const glm::dvec3 &voxel,
                     double most) {
  const Place place = place_of(scene.grid, index, voxel);
  if (place.row < 0) return most;
  const auto row = static_cast<std::size_t>(place.row);
  double least = most;
  for (std::uint64_t i = index.offset[row]; i < index.offset[row + 1]; i++) {
    const IndexEntry &entry = index.entry[i];
    const Cone &other = scene.cone[entry.cone];
    const glm::ivec3 lift(entry.lift[0], entry.lift[1], entry.lift[2]);
    if (other.cell == cone.cell && lift == place.lift) continue;
    const glm::dvec3 seen = voxel + glm::dvec3((place.lift - lift) * scene.grid.size);
    least = cone_distance_below(scene.grid, other, seen, least);
  }
  return least;
}

constexpr double kApart = 2; // steps between the points of an axis that are looked at

// The least of a cone: how much neighbours leave on one side of its axis, in units, and where.
struct Narrowest {
  float left = 0, radius = 0;
  glm::vec3 voxel{};
};

Narrowest narrowest_of(const Scene &scene, const Index &index, const Cone &cone) {
  const glm::dvec3 a = glm::dvec3(cone.a) / double(kFixed), b = glm::dvec3(cone.b) / double(kFixed);
  const double ra = cone.ra / double(kFixed), rb = cone.rb / double(kFixed);
  const int parts = std::max(1, static_cast<int>(std::ceil(glm::length(b - a) / kApart)));
  Narrowest out;
  for (int i = 1; i <= parts; i++) {
    const double t = double(i) / parts, radius = ra + t * (rb - ra);
    const glm::dvec3 voxel = a + t * (b - a);
    const double other = nearest_other(scene, index, cone, voxel, radius + scene.gap);
    const auto left = static_cast<float>(0.5 * (radius + other - scene.gap));
    if (i == 1 || left < out.left) out = {left, static_cast<float>(radius), glm::vec3(voxel)};
  }
  return out;
}

} // namespace

std::vector<Pinch> predict_pinches(const Scene &scene, const Index &index, Workers &workers) {
  const double unit = scene.grid.unit;
  const auto is_thin = [&](const Cone &cone) { // those are named by themselves
    return cone.kind == kSomaKind || std::min(cone.ra, cone.rb) < kThinnestTube * kFixed;
  };
  std::vector<Narrowest> narrowest(scene.cone.size());
  workers.loop(scene.cone.size(), 256, [&](std::size_t i, unsigned) {
    if (!is_thin(scene.cone[i])) narrowest[i] = narrowest_of(scene, index, scene.cone[i]);
  });
  std::vector<Pinch> out;
  for (std::size_t i = 0; i < scene.cone.size(); i++) {
    const Cone &cone = scene.cone[i];
    const Narrowest &n = narrowest[i];
    if (is_thin(cone) || n.left >= kThinnestTube) continue;
    if (out.empty() || out.back().cell != cone.cell) out.push_back({cone.cell, 0, 1e300, 0, {}});
    Pinch &pinch = out.back();
    pinch.segments++;
    if (n.left * unit >= pinch.left_um) continue;
    pinch.left_um = n.left * unit, pinch.radius_um = n.radius * unit;
    pinch.where = scene.grid.origin + glm::dvec3(n.voxel) * scene.grid.step;
  }
  return out;
}

} // namespace conceg::mesh
