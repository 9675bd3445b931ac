// SPDX-License-Identifier: BSD-3-Clause
// From grown projections to the skeleton's points and the bars' report.
#pragma once

#include "course.hpp"

namespace conceg::grow {

// Bar states as stored.
enum BarState : std::uint8_t { bar_waiting = 0, bar_done = 1, bar_short = 2, bar_lost = 3, bar_handed = 4 };

struct Skeleton {
  std::vector<std::uint64_t> cell_offset;
  std::vector<glm::dvec3> position; // unwrapped
  std::vector<float> radius, target_radius;
  std::vector<std::int64_t> parent; // within the cell, -1 = on the soma
  std::vector<std::uint8_t> kind, status;
  std::vector<std::uint32_t> branch, bar, tree;
};

struct BarReport {
  std::vector<double> achieved_start, achieved_end;
  std::vector<std::uint8_t> state;
  std::vector<std::int64_t> handed_to; // row within the cell
};

// Points of every cell in preorder; the continuing branch comes before the daughters.
Skeleton deliver_skeleton(const State &state);
BarReport deliver_bars(const State &state);

struct Measures {
  double cable_um = 0.0;
  double straightness = 0.0;         // mean over branches longer than 2 um, as delivered
  std::vector<Straightness> of_type; // the same of each type, resampled at 1 um as the dictionary's is
  double volume_committed_um3 = 0.0; // somas and round cones at the committed radii
  double volume_target_um3 = 0.0;    // the same at the target radii
};
Measures measure(const State &state, const Skeleton &skeleton);

// What was asked of the cells without a soma, and what grew.
struct FreeCable {
  std::uint64_t cells = 0, cut_short = 0, lost = 0;
  double asked_um = 0.0, grown_um = 0.0;
};
FreeCable measure_free_cable(const State &state, const BarReport &report);

} // namespace conceg::grow
