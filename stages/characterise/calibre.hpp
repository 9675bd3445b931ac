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

// `path` ascends; `radius` at those places, > 0. `residual` (may be null) receives ln r about the tapered
// line every 1 um, without its mean; nothing for bars that are too short for a taper.
Calibre measure_calibre(const std::vector<double> &path, const std::vector<double> &radius,
                        std::vector<double> *residual = nullptr);

// How finely the radii of a reconstruction were traced.
enum class Trace { none, continuous, quantised, constant };
const char *name_of(Trace trace);
// quantised: fewer than one value in 20 samples (radii in whole pixels); constant: more than half of the
// samples share one value. Below 100 samples no verdict: continuous.
Trace trace_of(std::vector<double> radii);

// Fluctuation of the radii of many bars together: one autocovariance of ln r over all of 10 um and more, in
// which long bars count more and none cuts the correlation off.
class CalibrePool {
public:
  void add(const Calibre &bar, double length, const std::vector<double> &residual);
  void add(const CalibrePool &other);
  double radius() const; // length-weighted mean, um
  double cv() const;     // standard deviation of ln r; 0 without samples
  double
  correlation_length() const; // um; where the autocorrelation falls below 1/e, at most 64 um; 0 = no samples

private:
  static constexpr std::size_t lags = 65; // 0 .. 64 um
  double radius_sum_ = 0.0, length_ = 0.0;
  std::vector<double> sum_ = std::vector<double>(lags), count_ = std::vector<double>(lags);
};

} // namespace conceg::characterise
