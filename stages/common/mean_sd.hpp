// SPDX-License-Identifier: BSD-3-Clause
// Mean and standard deviation of a sample.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace conceg {

struct MeanSd {
  std::uint64_t count = 0;
  double mean = 0.0, sd = 0.0; // n - 1; 0 when there are too few values
};

inline MeanSd mean_of(const std::vector<double> &values) {
  MeanSd out;
  out.count = values.size();
  if (values.empty()) return out;
  for (const double value : values)
    out.mean += value;
  out.mean /= static_cast<double>(values.size());
  if (values.size() < 2) return out;
  for (const double value : values)
    out.sd += (value - out.mean) * (value - out.mean);
  out.sd = std::sqrt(out.sd / static_cast<double>(values.size() - 1));
  return out;
}

} // namespace conceg
