// SPDX-License-Identifier: BSD-3-Clause
// Faces that follow one another lie near one another, so up to eight of them go through the hash as one leaf.
#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace conceg::mesh {

constexpr std::uint32_t kLeaf = 8; // faces

struct Bounds {
  glm::dvec3 low{1e300}, high{-1e300};
  void add(const Bounds &b) { low = glm::min(low, b.low), high = glm::max(high, b.high); }
};

// Faces first .. first + count of one surface.
struct Leaf {
  std::uint32_t first = 0, count = 0;
  Bounds whole;
  std::array<Bounds, kLeaf> face;
};

// A leaf in the slab, moved by -lift sides into the base box. Boxes are relative to its low corner and
// rounded outwards.
struct Item {
  glm::ivec3 first, last; // hash places of the box with its margin
  std::uint32_t surface, face, count;
  std::int16_t lift[3];
  std::uint8_t changed; // one bit a face
  float low[3], high[3];
  float face_low[3][kLeaf], face_high[3][kLeaf];
};

// Items in blocks, so that a long list takes no more than they do.
class Items {
public:
  void add(const Item &item) {
    if (count_ == block_.size() * kBlockItems) block_.push_back(std::make_unique<Item[]>(kBlockItems));
    (*this)[count_++] = item;
  }
  std::size_t size() const { return count_; }
  void clear() { count_ = 0; }
  Item &operator[](std::size_t i) { return block_[i / kBlockItems][i % kBlockItems]; }
  const Item &operator[](std::size_t i) const { return block_[i / kBlockItems][i % kBlockItems]; }

private:
  static constexpr std::size_t kBlockItems = 1024;
  std::vector<std::unique_ptr<Item[]>> block_;
  std::size_t count_ = 0;
};

// Which faces of two leaves have boxes that meet, or that are no farther apart than `far` along any axis: one
// byte a pair.
struct BoxPairs {
  std::uint8_t meet[kLeaf][kLeaf], near[kLeaf][kLeaf];
};

void compare_boxes(const Item &a, const Item &b, float far, BoxPairs &out);

} // namespace conceg::mesh
