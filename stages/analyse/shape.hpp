// SPDX-License-Identifier: BSD-3-Clause
// Branches of one cell as sums, whether it is known by its samples or by its bars alone.
#pragma once

#include "metrics.hpp"

#include <cstddef>
#include <cstdint>

namespace conceg::analyse {

struct Shape {
  std::uint64_t branches = 0, tips = 0, bifurcations = 0;
  double order = 0, cable_um = 0, angle_rad = 0;     // sums over branches, over bifurcations
  std::uint64_t judged = 0;                          // branches long enough to be called straight
  double straightness = 0, straightness_squared = 0; // sums over those
  double mean_order() const { return order / static_cast<double>(branches); }
  double mean_length_um() const { return cable_um / static_cast<double>(branches); }
  double mean_angle_degree() const;
};

enum class Part { dendrites, axon }; // dendrites: all that is not axon, processes of glia too
constexpr std::uint8_t axon_code = 2;

// Of the trees of one part of a cell.
Shape shape_of(const metrics::Metrics &cell, Part part);

// Bars of one tree, or of all trees of a cell: parents are rows among these, before their children, -1 = root
// bar.
struct BarList {
  const double *start, *end, *angle; // path length in um; angle of the fork that a bar leaves, rad
  const std::int64_t *parent;
  std::size_t count;
};
// Adds the branches of the bars: a bar is cut where others start on it; a fork of k daughters counts once.
// `chosen` (may be null) says which bars to take; it must not divide a tree.
void add_bars(const BarList &bars, const std::uint8_t *chosen, Shape &sum);

} // namespace conceg::analyse
