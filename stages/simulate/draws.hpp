// SPDX-License-Identifier: BSD-3-Clause
// Random directions and normals of one walker, drawn a block at a time in loops that the compiler can
// vectorise. The bits are those of the library's generator (rng.h), both halves of each of its blocks, so
// they depend on seed, walker and draw alone.
#pragma once

#include "conceg/rng.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>

namespace conceg::simulate {

inline constexpr std::size_t draw_block = 64;

// The first half of a value is that of conceg_rng_u64, the second its neighbour in the same block; half as
// many blocks as values are used up.
void fill_bits(conceg_rng &rng, std::uint64_t bits[draw_block]);
// Unit vectors, uniform on the sphere, from 32 bits for the height and 32 for the angle each.
void fill_directions(const std::uint64_t bits[draw_block], double x[draw_block], double y[draw_block],
                     double z[draw_block]);
// Standard normals, two from each value (Box and Muller); the largest possible one is 6.8.
void fill_normals(const std::uint64_t bits[draw_block], double normal[2 * draw_block]);

class Directions {
public:
  explicit Directions(const conceg_rng &rng) : rng_(rng) {}
  glm::dvec3 next() {
    if (used_ == draw_block) refill();
    const std::size_t i = used_++;
    return {x_[i], y_[i], z_[i]};
  }

private:
  void refill() {
    std::uint64_t bits[draw_block];
    fill_bits(rng_, bits);
    fill_directions(bits, x_, y_, z_);
    used_ = 0;
  }
  conceg_rng rng_;
  std::size_t used_ = draw_block;
  double x_[draw_block], y_[draw_block], z_[draw_block];
};

class Normals {
public:
  explicit Normals(const conceg_rng &rng) : rng_(rng) {}
  // Three at once.
  glm::dvec3 next() {
    if (used_ + 3 > 2 * draw_block) refill();
    const std::size_t i = used_;
    used_ += 3;
    return {normal_[i], normal_[i + 1], normal_[i + 2]};
  }

private:
  void refill() {
    std::uint64_t bits[draw_block];
    fill_bits(rng_, bits);
    fill_normals(bits, normal_);
    used_ = 0;
  }
  conceg_rng rng_;
  std::size_t used_ = 2 * draw_block;
  double normal_[2 * draw_block];
};

} // namespace conceg::simulate
