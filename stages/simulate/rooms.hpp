// SPDX-License-Identifier: BSD-3-Clause
// Convex rooms between membranes: a step from a point of a room to another one of it meets no membrane.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <vector>

#if defined(__SSE4_1__)
#include <smmintrin.h>
#endif

namespace conceg::simulate {

// Eight half spaces n . p < offset around the centre of a voxel, in bytes: per side n in 1/127, offset in the
// builder's `unit_um` / 127, rounded so that the room only shrinks. The test is in whole numbers, alike on
// every machine.
struct alignas(32) Room {
  std::int8_t side[8][4] = {{0, 0, 0, -128}}; // as it is: holds no point
  // Whether both points lie in the room, farther from its sides than the clearance. `scale`: steps / unit_um.
  bool holds(const glm::dvec3 &from, const glm::dvec3 &to, double scale) const;
  static constexpr int steps = 16384; // of a coordinate, in a unit
};

// Rooms of one voxel after the other: clear, add the faces that can be met from it, build.
class RoomBuilder {
public:
  // `unit_um`: at least the distance from the voxel's centre of all that holds() will be asked for.
  // `crossed_um`: half the voxel's diagonal.
  RoomBuilder(double unit_um, double crossed_um) : unit_(unit_um), crossed_(crossed_um) {}
  void clear() { face_.clear(); }
  // Corners from the voxel's centre; unit normal, out of the cell.
  void add(const std::array<glm::dvec3, 3> &corner, const glm::dvec3 &normal) {
    face_.push_back({corner, normal});
  }
  // The rooms outside (0) and inside (1) the cells. Where none is found, the room stays as it is.
  void build(Room &outside, Room &inside);

private:
  static constexpr std::size_t most_faces = 256; // of a room; more are met without one
  using Faces = std::bitset<most_faces>;
  struct Face {
    std::array<glm::dvec3, 3> corner;
    glm::dvec3 normal;
  };
  struct Near {
    double squared;
    std::uint32_t face;
    glm::dvec3 point; // from the seed
  };
  struct Side {
    glm::dvec3 normal;
    double depth = 0.0; // from the seed
    Faces beyond;
  };
  static constexpr std::size_t most_sides = 8;

  void look_from(const glm::dvec3 &seed);
  bool is_inside() const;
  bool part(double slack);
  Side side(std::uint32_t face, const glm::dvec3 &normal, double slack, const Faces &open) const;
  Room rounded() const;
  void build_here(Room &room);

  double unit_, crossed_;
  std::vector<Face> face_;
  glm::dvec3 seed_ = glm::dvec3(0.0);
  std::vector<Near> near_; // from the seed, nearest first
  std::array<Side, most_sides> side_;
  std::size_t sides_ = 0;
};

inline bool Room::holds(const glm::dvec3 &from, const glm::dvec3 &to, double scale) const {
  // Rounding of the coordinates takes at most 127 * 3 / 2 of it, the clearance a few; it is less than 1e-4
  // um.
  constexpr int margin = 256;
#if defined(__SSE4_1__)
  const auto spread = [scale](const glm::dvec3 &p) {
    const __m128i xy = _mm_cvtpd_epi32(_mm_mul_pd(_mm_set_pd(p.y, p.x), _mm_set1_pd(scale))),
                  z = _mm_cvtpd_epi32(_mm_set_pd(-steps, p.z * scale));
    const __m128i all = _mm_unpacklo_epi64(xy, z);
    return _mm_packs_epi32(all, all);
  };
  const __m128i a = spread(from), b = spread(to), least = _mm_set1_epi32(-margin);
  __m128i held = _mm_set1_epi32(-1);
  for (int k = 0; k < 8; k += 4) {
    const __m128i bytes = _mm_load_si128(reinterpret_cast<const __m128i *>(side[k]));
    const __m128i low = _mm_cvtepi8_epi16(bytes), high = _mm_cvtepi8_epi16(_mm_srli_si128(bytes, 8));
    held = _mm_and_si128(
        held, _mm_cmpgt_epi32(least, _mm_hadd_epi32(_mm_madd_epi16(low, a), _mm_madd_epi16(high, a))));
    held = _mm_and_si128(
        held, _mm_cmpgt_epi32(least, _mm_hadd_epi32(_mm_madd_epi16(low, b), _mm_madd_epi16(high, b))));
  }
  return _mm_movemask_epi8(held) == 0xffff;
#else
  for (const glm::dvec3 &p : {from, to})
    for (const std::int8_t(&s)[4] : side) {
      long height = -long{steps} * s[3];
      for (int axis = 0; axis < 3; axis++)
        height += s[axis] * std::lrint(p[axis] * scale);
      if (height >= -margin) return false;
    }
  return true;
#endif
}

} // namespace conceg::simulate
