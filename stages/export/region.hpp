// SPDX-License-Identifier: BSD-3-Clause
// Triangles of a plane region of any outline, with holes, in n log n and without a point of their own.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace conceg::exporting {

// Fixed-point coordinates; differences must fit into 62 bits.
struct PlanePoint {
  std::int64_t u, v;
};

// The region lies to the left of its directed edges (rows of `point`): outlines run anticlockwise, holes
// clockwise, of each point one edge leaves and one arrives. Calls use(a, b, c) for triangles that run
// anticlockwise. A sweep cuts the region into monotone pieces (de Berg and others, Computational Geometry,
// chapter 3); all decisions are exact and depend on places, not on numbers. -1 when done, else a point where
// edges meet or cross as they must not.
std::int64_t triangulate_region(const std::vector<PlanePoint> &point,
                                const std::vector<std::pair<std::uint32_t, std::uint32_t>> &edge,
                                const std::function<void(std::uint32_t, std::uint32_t, std::uint32_t)> &use);

} // namespace conceg::exporting
