// SPDX-License-Identifier: BSD-3-Clause
// Sections of the skeletons (runs between root, fork and tip), and what moving did to them: lengths,
// straightness and fork angles, as DESIGN defines them.
#pragma once

#include "chains.hpp"
#include "parallel.hpp"

#include <cstdint>
#include <vector>

namespace conceg::relax {

constexpr std::uint32_t no_section = 0xffffffffu;

struct Sections {
  std::vector<std::uint32_t> of_point; // section of the segment that ends at a point; none for a root
  std::vector<std::uint32_t> offset,
      point;                  // CSR: the points of each section in order, the one it leaves first
  std::vector<double> length; // um, at the start
  std::size_t count() const { return length.size(); }
};

// Sections of the bodies, with their lengths as they stand.
Sections make_sections(const Bodies &bodies);

double length_of(const Bodies &bodies, const Sections &sections, std::size_t section);

// Shorter sections have no straightness.
constexpr double shortest_judged_um = 2.0;

struct Shape {
  std::vector<double> length; // per section, um
  std::vector<double>
      straightness;          // per section, end to end over path, resampled every 1 um; -1 = not judged
  std::vector<double> angle; // rad, of each fork of two, between the first segments of its daughters
};

// End to end over path, resampled every 1 um; -1 for a section that is not judged.
double straightness_of(const Bodies &bodies, const Sections &sections, std::size_t section);

Shape measure_shape(const Bodies &bodies, const Sections &sections, Workers &workers);

struct ShapeChange {
  std::size_t sections = 0, forks = 0;
  double length_within = 0, angle_within = 0;             // shares within 3 % and within 3 degrees
  double mean_length_ratio = 1, worst_length_change = 0;  // worst of the judged sections
  double straightness_before = 0, straightness_after = 0; // means over the judged sections
  double mean_angle_before = 0, mean_angle_after = 0;     // rad
};

constexpr double length_tolerance = 0.03, angle_tolerance = 3 * 3.14159265358979323846 / 180; // rad

ShapeChange compare_shapes(const Shape &before, const Shape &after);

} // namespace conceg::relax
