// SPDX-License-Identifier: BSD-3-Clause
// Two samples of one measure beside each other, as effect sizes and as distances of their distributions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conceg::analyse {

// A weighted sample: its weights sum to `count`, and a weight w counts as w equal values.
struct Side {
  double count = 0, mean = 0, sd = 0; // n - 1; mean of nothing = 0, sd of fewer than two values = 0
};

// NaN where it is not defined.
struct TwoSamples {
  Side a, b;
  double cohens_d = 0;    // (mean_a - mean_b) / sqrt(((n_a - 1) s_a^2 + (n_b - 1) s_b^2) / (n_a + n_b - 2))
  double sd_ratio = 0;    // s_a / s_b
  double wasserstein = 0; // first distance: integral of abs(F_a - F_b)
  double kolmogorov = 0;  // largest abs(F_a - F_b)
};

// Values in clusters (the branches of a cell, or one value of each), sorted once, so that any choice of
// clusters for the two sides is compared in one pass. The sides may share clusters.
class ClusteredValues {
public:
  explicit ClusteredValues(const std::vector<std::vector<double>> &clusters);
  // Weights per cluster, >= 0; each value of a cluster has its weight.
  TwoSamples compare(const std::vector<double> &weight_a, const std::vector<double> &weight_b) const;

private:
  std::vector<double> value_; // ascending; equal values by cluster
  std::vector<std::uint32_t> cluster_;
};

// P(D >= found) for two samples of the same continuous distribution, independent values; Stephens'
// approximation to Kolmogorov's law.
double kolmogorov_p(double distance, double count_a, double count_b);

// The smallest value that a share `at` of the values does not exceed; NaN ones are left out, NaN without any.
double quantile_of(std::vector<double> values, double at);
// Of those that are not NaN; NaN without any.
double mean_of_known(const std::vector<double> &values);

} // namespace conceg::analyse
