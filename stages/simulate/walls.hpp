// SPDX-License-Identifier: BSD-3-Clause
// The membranes as a walker meets them: the box is cut into voxels, and each lists the triangle images that a
// move from within it can meet, so that one look finds all candidates; boxes in bytes dismiss most of them,
// our own double arithmetic decides about the rest. Each voxel also has convex rooms in which nothing is met,
// and a finer grid knows how far the nearest membrane is at least.
#pragma once

#include "boxes.hpp"
#include "huge.hpp"
#include "parallel.hpp"
#include "rooms.hpp"
#include "wrap.hpp"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace conceg::simulate {

// A walker never comes nearer to a membrane than this (um): far above the rounding of double coordinates,
// far below a step.
inline constexpr double clearance_um = 1e-6;

// Triangles of all cells: vertices in um, corners anticlockwise seen from outside.
struct Membranes {
  std::vector<glm::dvec3> vertex;
  std::vector<glm::uvec3> face;
  std::vector<std::uint32_t> cell; // per face
  std::vector<std::uint8_t> code;  // per face: compartment
};

struct Contact {
  double at = 1.0; // share of the move until it is `clearance_um` short of the membrane
  std::uint32_t face = none;
  glm::dvec3 normal = glm::dvec3(0.0); // outward, unit
  static constexpr std::uint32_t none = ~0u;
};

// Where a place lies among the voxels.
struct Spot {
  std::size_t voxel = 0, fine = 0;
  glm::dvec3 from_centre = glm::dvec3(0.0);
  bool known = false; // false: beyond the grid on an open axis, and beyond the reach of every membrane
};

class Walls {
public:
  // `reach_um`: the longest move that first_contact will be asked for. E_RANGE when the grid would be too
  // large, or a face lies too far away.
  Walls(const conceg_box &box, const Membranes &membranes, double reach_um, Workers &workers,
        const Progress &progress);

  // Places below are local: from the box's lower corner, inside the box on periodic axes.
  glm::dvec3 local(const glm::dvec3 &position) const { return wrap(box_, position) - origin_; }
  glm::dvec3 position(const glm::dvec3 &place) const { return place + origin_; }
  // Brings a place that left the box by less than a side back into it, on periodic axes.
  void wrap_place(glm::dvec3 &place) const {
    for (int axis = 0; axis < 3; axis++) {
      if (place[axis] < side_[axis] && place[axis] >= 0.0) continue;
      if (!box_.periodic[axis]) continue;
      place[axis] -= side_[axis] * std::floor(place[axis] / side_[axis]);
      if (place[axis] >= side_[axis]) place[axis] = 0.0; // -1e-20 + side rounds to side
    }
  }

  Spot spot(const glm::dvec3 &place) const {
    const double fx = (place.x - low_.x) * scale_.x, fy = (place.y - low_.y) * scale_.y,
                 fz = (place.z - low_.z) * scale_.z;
    if (any_open_ &&
        !(fx >= 0.0 && fy >= 0.0 && fz >= 0.0 && fx < count_.x && fy < count_.y && fz < count_.z))
      return {};
    // Rounding of the product may reach count_ just below a periodic side.
    const int x = std::min(static_cast<int>(fx), count_.x - 1),
              y = std::min(static_cast<int>(fy), count_.y - 1),
              z = std::min(static_cast<int>(fz), count_.z - 1);
    Spot s;
    s.voxel = voxel_index(x, y, z), s.known = true;
    s.from_centre = {(fx - x - 0.5) * edge_.x, (fy - y - 0.5) * edge_.y, (fz - z - 0.5) * edge_.z};
    const auto half = [](double from_centre) { return from_centre >= 0.0 ? std::size_t{1} : std::size_t{0}; };
    s.fine = fine_factor_ == 1 ? s.voxel
                               : 8 * s.voxel + half(s.from_centre.x) + 2 * half(s.from_centre.y) +
                                     4 * half(s.from_centre.z);
    return s;
  }
  // No membrane is nearer than this (um); not above 0 when that is not known.
  double free_radius(const Spot &spot, const glm::dvec3 &place) const {
    if (!spot.known) return outside_radius(place);
    return free_unit_um * free_[spot.fine] - std::sqrt(from_fine_square(spot));
  }
  // free_radius > radius, without a root.
  bool is_free(const Spot &spot, const glm::dvec3 &place, double radius) const {
    if (!spot.known) return outside_radius(place) > radius;
    const double slack = free_unit_um * free_[spot.fine] - radius;
    return slack > 0.0 && from_fine_square(spot) < slack * slack;
  }
  // Whether it is known at a glance that a move of at most the reach meets nothing; `inside` a cell or not
  // says where to look first.
  bool is_clear(const Spot &spot, const glm::dvec3 &move, bool inside) const {
    if (!spot.known) return true;
    const Voxel &v = voxel_[spot.voxel];
    return v.begin == voxel_[spot.voxel + 1].begin ||
           room_[inside][v.room].holds(spot.from_centre, spot.from_centre + move, room_scale_);
  }

  // The first membrane, seen from any side, that a move from `place` meets or comes closer to than the
  // clearance. The move is not longer than the reach.
  Contact first_contact(const Spot &spot, const glm::dvec3 &place, const glm::dvec3 &move) const;

  // Compartment code of the face nearest to a place that lies in a cell; searches outward voxel by voxel.
  std::uint8_t nearest_code(const glm::dvec3 &place) const;

  std::uint32_t source(std::uint32_t face) const { return faces_[face].source; }
  std::size_t images() const { return faces_.size(); }
  std::size_t voxels() const { return voxel_.size() - 1; }
  std::uint64_t bytes() const;
  double voxel_um() const { return edge_[0]; }
  double reach_um() const { return reach_; }

private:
  // One image of a triangle.
  struct Face {
    glm::uvec3 corner;
    std::uint32_t source, lift;
  };
  // What a move is held against, apart from it: the plane, read for every candidate, and the face in it, for
  // those that the move crosses. A point of the plane has the barycentric coordinates gradient . p - offset
  // for two corners and the rest of 1 for the third.
  struct alignas(32) Plane {
    glm::dvec3 normal; // out of the cell
    double offset;
  };
  struct alignas(64) Inner {
    glm::dvec3 gradient[2];
    double offset[2];
  };
  struct Voxel {
    std::uint32_t begin = 0; // its faces: eights begin .. begin of the next voxel
    std::uint32_t room = 0;  // its pair of rooms, where it has faces
  };
  struct Entry {
    std::uint32_t voxel, face;
    std::uint8_t touched; // bits of its fine voxels that the face may cross
  };
  static constexpr double free_unit_um = 1.0 / 32.0; // distances are kept in bytes
  static constexpr double farthest_um = 255.0 * free_unit_um;
  void choose_grid(std::size_t faces);
  void list_images(const Membranes &membranes);
  std::vector<Entry> entries(std::size_t begin, std::size_t end) const;
  unsigned touched_parts(const Plane &plane, const glm::dvec3 &middle, const glm::dvec3 &low,
                         const glm::dvec3 &high) const;
  void sort_images(Workers &workers);
  void fill_voxels(Workers &workers, const Progress &progress);
  void fill_rooms(Workers &workers);
  void measure_distance(const std::vector<std::uint8_t> &touched, Workers &workers);
  std::array<glm::dvec3, 3> corners(const Face &face) const;
  static Inner inner_of(const std::array<glm::dvec3, 3> &corner, const glm::dvec3 &normal);
  static bool inside(const Inner &face, const glm::dvec3 &point);
  double outside_radius(const glm::dvec3 &place) const;

  int index_on(int axis, double x) const {
    const int i = static_cast<int>((x - low_[axis]) * scale_[axis]);
    return i < 0 ? 0 : i >= count_[axis] ? count_[axis] - 1 : i;
  }
  // Voxels stand in blocks of two by two by two, so that a walker's surroundings are in few cache lines.
  std::size_t voxel_index(int x, int y, int z) const {
    const auto ux = static_cast<std::size_t>(x), uy = static_cast<std::size_t>(y),
               uz = static_cast<std::size_t>(z);
    return (((uz >> 1) * blocks_[1] + (uy >> 1)) * blocks_[0] + (ux >> 1)) * 8 + (ux & 1) + 2 * (uy & 1) +
           4 * (uz & 1);
  }
  glm::ivec3 voxel_place(std::size_t voxel) const {
    const std::size_t block = voxel >> 3, x = block % blocks_[0], y = block / blocks_[0] % blocks_[1],
                      z = block / blocks_[0] / blocks_[1];
    return {static_cast<int>(2 * x + (voxel & 1)), static_cast<int>(2 * y + (voxel >> 1 & 1)),
            static_cast<int>(2 * z + (voxel >> 2 & 1))};
  }
  glm::dvec3 voxel_centre(const glm::ivec3 &at) const { return low_ + (glm::dvec3(at) + 0.5) * edge_; }
  // Among all fine voxels, x fastest.
  std::size_t fine_row(const glm::ivec3 &voxel, std::size_t part) const {
    const auto factor = static_cast<std::size_t>(fine_factor_);
    const std::size_t x = factor * static_cast<std::size_t>(voxel.x) + (part & 1),
                      y = factor * static_cast<std::size_t>(voxel.y) + (part >> 1 & 1),
                      z = factor * static_cast<std::size_t>(voxel.z) + (part >> 2);
    return (z * fine_count_[1] + y) * fine_count_[0] + x;
  }
  double from_fine_square(const Spot &spot) const {
    const double x = std::fabs(spot.from_centre.x) - fine_shift_.x,
                 y = std::fabs(spot.from_centre.y) - fine_shift_.y,
                 z = std::fabs(spot.from_centre.z) - fine_shift_.z;
    return x * x + y * y + z * z;
  }

  conceg_box box_;
  glm::dvec3 origin_, side_; // the box
  double reach_;
  bool any_open_;
  glm::dvec3 low_, edge_, scale_; // the grid, local: lower corner, voxel edges, their inverses
  glm::ivec3 count_;
  std::size_t blocks_[3] = {};
  int fine_factor_ = 1;            // fine voxels along a voxel's edge
  std::size_t fine_count_[3] = {}; // fine voxels
  glm::dvec3 fine_shift_{0.0};     // from a voxel's centre to those of its fine ones
  std::vector<glm::dvec3> vertex_, lift_;
  HugeVector<Face> faces_;
  HugeVector<Plane> plane_; // of each face
  HugeVector<Inner> inner_;
  HugeVector<Voxel> voxel_;  // one more than there are
  HugeVector<Room> room_[2]; // of each voxel that has faces: outside, inside
  double room_unit_um_ = 1.0, room_scale_ = 1.0;
  HugeVector<std::uint8_t>
      free_; // of each fine voxel: lower bound of the distance from its centre to a membrane
  ByteScale bytes_;
  HugeVector<EightBoxes> list_;    // of each voxel, filled up to eights by Contact::none
  std::vector<std::uint8_t> code_; // of the source faces
};

} // namespace conceg::simulate
