// SPDX-License-Identifier: BSD-3-Clause
// Radii along a bar: mean, taper, and how much they vary about it.
#pragma once

#include <cstddef>
#include <vector>

namespace conceg::characterise {

struct Calibre {
  double radius = 0.0; // length-weighted mean, um
  double taper = 0.0;  // um of radius per um of path; 0 for bars with fewer than 4 samples at 1 um
  double cv = 0.0;     // standard deviation of ln r about the tapered line
  double correlation_length =
      0.0; // where the autocorrelation of those residuals falls below 1/e, um; 0 = too short to tell
};

// `path` ascends; `radius` at those places, > 0.
Calibre measure_calibre(const std::vector<double> &path, const std::vector<double> &radius);

} // namespace conceg::characterise
