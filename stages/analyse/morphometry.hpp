// SPDX-License-Identifier: BSD-3-Clause
// Shape of the trees: sections (= branches, runs between root, fork and tip), their order, length,
// straightness and angles.
#pragma once

#include "straightness.hpp"
#include "tissue.hpp"

namespace conceg::analyse {

struct Section {
  std::uint32_t cell;
  int order;           // 1 at the root section
  double length;       // path, um
  double straightness; // end-to-end / path, resampled every 1 um; below 0 when the path is shorter than 2 um:
                       // not judged
  bool tip;            // ends free
};

struct Fork {
  std::uint32_t cell;
  double angle; // rad, between the first segments of its two daughters
};

// Tips of the apical dendrites of one cell, seen from its soma.
struct Apical {
  std::uint64_t tips = 0, pia_side = 0; // tips, and those on the pia's side of the soma
  double rise = 0;                      // um, sum of the tips' heights towards the pia
};

struct Morphometry {
  std::vector<Section> sections; // by cell, parents before children
  std::vector<Fork> forks;       // with exactly two daughters
  std::vector<Apical> apical;    // per cell
};

Morphometry measure_shape(const Cells &cells, const Skeletons &skeletons);

struct Spread {
  std::uint64_t count = 0;
  double mean = 0, sd = 0; // of the population; 0 when there is nothing
};
Spread spread_of(const std::vector<double> &values);

} // namespace conceg::analyse
