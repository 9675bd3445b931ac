// SPDX-License-Identifier: BSD-3-Clause
#include "rooms.hpp"

#include "distance_grid.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace conceg::simulate {

namespace {

constexpr double least_depth_um = 2e-3;                 // of a side from the room's seed
constexpr double slacks_um[] = {0.015, 0.05};           // by which sides may come nearer to part more faces
constexpr double seed_depths_um[] = {0.06, 0.03, 0.01}; // from the membrane, into the room

// Depth of the plane with this normal that all of a face lies beyond.
double depth_of(const std::array<glm::dvec3, 3> &corner, const glm::dvec3 &from, const glm::dvec3 &normal) {
  return std::min({glm::dot(normal, corner[0] - from), glm::dot(normal, corner[1] - from),
                   glm::dot(normal, corner[2] - from)});
}

} // namespace

void RoomBuilder::look_from(const glm::dvec3 &seed) {
  seed_ = seed, near_.clear();
  for (std::uint32_t f = 0; f < face_.size(); f++) {
    const Face &face = face_[f];
    const glm::dvec3 way = nearest_point(seed, face.corner[0], face.corner[1], face.corner[2]) - seed;
    near_.push_back({glm::dot(way, way), f, way});
  }
  std::sort(near_.begin(), near_.end(), [](const Near &a, const Near &b) {
    return a.squared < b.squared || (a.squared == b.squared && a.face < b.face);
  });
}

// By the side of the nearest face that the seed is on.
bool RoomBuilder::is_inside() const {
  const Face &nearest = face_[near_.front().face];
  return glm::dot(nearest.normal, seed_ - nearest.corner[0]) < 0.0;
}

RoomBuilder::Side RoomBuilder::side(std::uint32_t face, const glm::dvec3 &normal, double slack,
                                    const Faces &open) const {
  Side s;
  s.normal = normal, s.depth = depth_of(face_[face].corner, seed_, normal);
  const double least = std::max(least_depth_um, s.depth - slack);
  if (!(s.depth >= least)) return s;
  for (std::uint32_t f = 0; f < face_.size(); f++) {
    if (!open[f]) continue;
    const double depth = depth_of(face_[f].corner, seed_, normal);
    if (depth >= least) s.beyond.set(f), s.depth = std::min(s.depth, depth);
  }
  return s;
}

// Sides that part the seed from all faces, nearest first; false when there would be too many.
bool RoomBuilder::part(double slack) {
  Faces open;
  for (std::size_t f = 0; f < face_.size(); f++)
    open.set(f);
  sides_ = 0;
  for (const Near &near : near_) {
    if (!open[near.face]) continue;
    if (sides_ == most_sides) return false;
    // Along the face's own normal a side has most of its neighbours beyond it; along the way to an edge that
    // is seen from the side it lies deepest.
    const Face &face = face_[near.face];
    const bool turned = glm::dot(face.normal, face.corner[0] - seed_) < 0.0;
    Side best = side(near.face, turned ? -face.normal : face.normal, slack, open);
    const double distance = std::sqrt(near.squared);
    if (best.depth < 0.9 * distance) {
      const Side other = side(near.face, near.point / distance, slack, open);
      if (other.beyond.count() >= best.beyond.count()) best = other;
    }
    if (best.beyond.none()) return false;
    open &= ~best.beyond;
    side_[sides_++] = best;
  }
  return true;
}

// In bytes; the offsets are taken anew for the rounded normals.
Room RoomBuilder::rounded() const {
  Room room;
  for (std::int8_t(&side)[4] : room.side)
    side[3] = 127; // beyond all that is asked for
  for (std::size_t k = 0; k < sides_; k++) {
    const Side &s = side_[k];
    const glm::dvec3 n(std::round(127.0 * s.normal.x), std::round(127.0 * s.normal.y),
                       std::round(127.0 * s.normal.z));
    double depth = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < face_.size(); f++)
      if (s.beyond[f]) depth = std::min(depth, depth_of(face_[f].corner, glm::dvec3(0.0), n));
    const double offset = std::floor(depth / unit_);
    if (offset < -127.0) return Room();
    for (int axis = 0; axis < 3; axis++)
      room.side[k][axis] = static_cast<std::int8_t>(n[axis]);
    room.side[k][3] = static_cast<std::int8_t>(std::min(127.0, offset));
  }
  return room;
}

void RoomBuilder::build_here(Room &room) {
  for (const double slack : slacks_um)
    if (part(slack)) {
      room = rounded();
      return;
    }
}

void RoomBuilder::build(Room &outside, Room &inside) {
  Room *const rooms[2] = {&outside, &inside};
  if (face_.empty() || face_.size() > most_faces) return;
  look_from(glm::dvec3(0.0));
  const bool here = is_inside();
  const glm::dvec3 outward = face_[near_.front().face].normal;
  const double distance = std::sqrt(near_.front().squared);
  if (distance >= seed_depths_um[0]) build_here(*rooms[here]);
  if (distance > crossed_) return; // no membrane crosses the voxel: it has one side
  for (const bool wanted : {false, true}) {
    if (wanted == here && distance >= seed_depths_um[0]) continue;
    for (const double depth : seed_depths_um) {
      const double way = wanted == here ? depth - distance : depth + distance;
      look_from((wanted ? -way : way) * outward);
      if (is_inside() != wanted) continue;
      build_here(*rooms[wanted]);
      break;
    }
  }
}

} // namespace conceg::simulate
