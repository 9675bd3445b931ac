// SPDX-License-Identifier: BSD-3-Clause
#include "blocks.hpp"

#include "ray_faces.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <cmath>

namespace conceg::analyse {

namespace {

constexpr long most_images = 64; // that one face lies over; more mean a broken coordinate

// A face over the block: the ray that it sees is the block's + lift * side of the box.
struct Over {
  std::uint32_t surface, face;
  int lift_x, lift_y;
};

// Images in which [low, high] and [from, to] overlap: from + lift * side <= high, to + lift * side >= low.
struct Lifts {
  long first, last;
};
Lifts lifts(double low, double high, double from, double to, double side, bool periodic) {
  if (!periodic) return high >= from && low <= to ? Lifts{0, 0} : Lifts{1, 0};
  const double first = std::ceil((low - to) / side), last = std::floor((high - from) / side);
  if (!(last - first < most_images))
    fail(CONCEG_E_RANGE, "/meshes/face: a face reaches over %g images of the box: expected it near its cell",
         last - first);
  return {static_cast<long>(first), static_cast<long>(last)};
}

std::vector<Over> faces_over(const Meshes &meshes, const conceg_box &box, const Block &block) {
  std::vector<Over> out;
  const double side_x = conceg_box_side(&box, 0), side_y = conceg_box_side(&box, 1);
  for (std::size_t k = 0; k < meshes.cell.size(); k++)
    for (std::size_t f = meshes.face_offset[k]; f < meshes.face_offset[k + 1]; f++) {
      const Flat flat = flatten(meshes, 0, 1, 2, k, f);
      const auto [low_x, high_x] = std::minmax({flat.u[0], flat.u[1], flat.u[2]});
      const auto [low_y, high_y] = std::minmax({flat.v[0], flat.v[1], flat.v[2]});
      const Lifts x = lifts(low_x, high_x, block.lo.x, block.lo.x + block.side, side_x, box.periodic[0] != 0);
      if (x.first > x.last) continue;
      const Lifts y = lifts(low_y, high_y, block.lo.y, block.lo.y + block.side, side_y, box.periodic[1] != 0);
      for (long i = x.first; i <= x.last; i++)
        for (long j = y.first; j <= y.last; j++)
          out.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(f), static_cast<int>(i),
                         static_cast<int>(j)});
    }
  return out;
}

// How many surfaces hold the voxels of one ray, as the first voxel's number and changes from there on.
class Ray {
public:
  Ray(const conceg_box &box, const Block &block, std::size_t voxels)
      : periodic_(box.periodic[2] != 0), length_(conceg_box_side(&box, 2)),
        step_(block.side / static_cast<double>(voxels)), first_(block.lo.z + 0.5 * step_),
        change_(voxels + 1, 0) {}
  void clear() { std::fill(change_.begin(), change_.end(), 0); }
  void cross(int sign, double at) {
    // Of all images of the voxel, those below the face (a number up to a constant that a closed surface
    // cancels), and the first voxel that has one less.
    const double below = periodic_ ? std::ceil((at - first_) / length_) : (at > first_ ? 1 : 0);
    change_[0] += sign * static_cast<long>(below);
    const double image = periodic_ ? at - (below - 1) * length_ : at;
    if (!periodic_ && below < 1) return;
    for (double next = image;; next += length_) {
      const double voxel = std::ceil((next - first_) / step_);
      if (voxel >= static_cast<double>(change_.size())) break;
      change_[static_cast<std::size_t>(std::max(0.0, voxel))] -= sign;
      if (!periodic_) break;
    }
  }
  void write(std::uint8_t *open) const {
    long inside = 0;
    for (std::size_t z = 0; z + 1 < change_.size(); z++)
      inside += change_[z], open[z] = inside == 0;
  }

private:
  bool periodic_;
  double length_, step_, first_;
  std::vector<long> change_;
};

} // namespace

std::vector<Block> choose_blocks(const conceg_box &box, std::size_t count, double side, std::uint64_t seed) {
  std::vector<Block> out;
  for (std::size_t b = 0; b < count; b++) {
    conceg_rng rng = conceg_rng_stream(seed, "analyse.blocks", b);
    Block block = {glm::dvec3(0.0), side};
    for (int a = 0; a < 3; a++) {
      const double length = conceg_box_side(&box, a), room = box.periodic[a] ? length : length - side;
      if (side > length * (1 + 1e-9))
        fail(CONCEG_E_RANGE, "block_um: blocks of %g um do not fit the box, which is %g um along axis %d",
             side, length, a);
      block.lo[a] = box.lo[a] + conceg_rng_uniform(&rng) * std::max(0.0, room);
    }
    out.push_back(block);
  }
  return out;
}

OpenVoxels block_voxels(const Meshes &meshes, const conceg_box &box, const Block &block, std::size_t voxels,
                        Workers &workers) {
  const double step = block.side / static_cast<double>(voxels);
  OpenVoxels out = {{voxels, voxels, voxels}, {}, {step, step, step}, {{false, false, false}}};
  out.open.assign(voxels * voxels * voxels, 1);
  const std::vector<Over> over = faces_over(meshes, box, block);
  const auto ray_at = [&](std::size_t a, std::size_t i) {
    return block.lo[static_cast<int>(a)] + (static_cast<double>(i) + 0.5) * step;
  };
  const double side_x = conceg_box_side(&box, 0), side_y = conceg_box_side(&box, 1);
  constexpr std::size_t slab = 4; // planes across x that are worked on together
  workers.loop((voxels + slab - 1) / slab, 1, [&](std::size_t s, unsigned) {
    const std::size_t from = s * slab, to = std::min(voxels, from + slab);
    std::vector<Ray> ray((to - from) * voxels, Ray(box, block, voxels));
    for (const Over &o : over) {
      const Flat flat = flatten(meshes, 0, 1, 2, o.surface, o.face);
      const double shift_x = o.lift_x * side_x, shift_y = o.lift_y * side_y;
      const auto [low_x, high_x] = std::minmax({flat.u[0], flat.u[1], flat.u[2]});
      const auto [low_y, high_y] = std::minmax({flat.v[0], flat.v[1], flat.v[2]});
      // One ray more on each side than the bounds: the lifted rays are rounded.
      const auto bound = [&](double t, int a, double shift, double more) {
        return std::clamp((t - shift - block.lo[a]) / step - 0.5 + more, 0.0, static_cast<double>(voxels));
      };
      const auto x_from = std::max(from, static_cast<std::size_t>(bound(low_x, 0, shift_x, -1))),
                 x_to = std::min(to, static_cast<std::size_t>(bound(high_x, 0, shift_x, 2))),
                 y_from = static_cast<std::size_t>(bound(low_y, 1, shift_y, -1)),
                 y_to = static_cast<std::size_t>(bound(high_y, 1, shift_y, 2));
      for (std::size_t x = x_from; x < x_to; x++)
        for (std::size_t y = y_from; y < y_to; y++) {
          double at;
          if (const int sign = crossing(flat, ray_at(0, x) + shift_x, ray_at(1, y) + shift_y, at))
            ray[(x - from) * voxels + y].cross(sign, at);
        }
    }
    for (std::size_t x = from; x < to; x++)
      for (std::size_t y = 0; y < voxels; y++)
        ray[(x - from) * voxels + y].write(&out.open[(x * voxels + y) * voxels]);
  });
  return out;
}

} // namespace conceg::analyse
