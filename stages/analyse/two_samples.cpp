// SPDX-License-Identifier: BSD-3-Clause
#include "two_samples.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conceg::analyse {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

struct Sums {
  double weight = 0, sum = 0, squares = 0; // squares: about the mean
  Side side() const {
    Side out;
    out.count = weight;
    if (weight > 0) out.mean = sum / weight;
    if (weight > 1) out.sd = std::sqrt(squares / (weight - 1));
    return out;
  }
};

double effect(const Side &a, const Side &b) {
  const double freedom = a.count + b.count - 2;
  if (!(a.count > 0 && b.count > 0 && freedom > 0)) return undefined;
  const double variance =
      (std::max(0.0, a.count - 1) * a.sd * a.sd + std::max(0.0, b.count - 1) * b.sd * b.sd) / freedom;
  return variance > 0 ? (a.mean - b.mean) / std::sqrt(variance) : undefined;
}

} // namespace

ClusteredValues::ClusteredValues(const std::vector<std::vector<double>> &clusters) {
  std::vector<std::pair<double, std::uint32_t>> all;
  for (std::uint32_t c = 0; c < clusters.size(); c++)
    for (const double value : clusters[c])
      all.emplace_back(value, c);
  std::sort(all.begin(), all.end());
  for (const auto &[value, c] : all)
    value_.push_back(value), cluster_.push_back(c);
}

TwoSamples ClusteredValues::compare(const std::vector<double> &weight_a,
                                    const std::vector<double> &weight_b) const {
  Sums a, b;
  for (std::size_t i = 0; i < value_.size(); i++) {
    const double wa = weight_a[cluster_[i]], wb = weight_b[cluster_[i]];
    a.weight += wa, a.sum += wa * value_[i], b.weight += wb, b.sum += wb * value_[i];
  }
  TwoSamples out;
  out.cohens_d = out.sd_ratio = out.wasserstein = out.kolmogorov = undefined;
  const double mean_a = a.side().mean, mean_b = b.side().mean;
  const bool both = a.weight > 0 && b.weight > 0;
  if (both) out.wasserstein = out.kolmogorov = 0;
  double below_a = 0, below_b = 0; // weights up to value i
  for (std::size_t i = 0; i < value_.size(); i++) {
    const double wa = weight_a[cluster_[i]], wb = weight_b[cluster_[i]];
    a.squares += wa * (value_[i] - mean_a) * (value_[i] - mean_a);
    b.squares += wb * (value_[i] - mean_b) * (value_[i] - mean_b);
    below_a += wa, below_b += wb;
    // Equal values count together: the distributions differ between values alone.
    const double gap = i + 1 < value_.size() ? value_[i + 1] - value_[i] : 0.0;
    if (!both || !(gap > 0)) continue;
    const double apart = std::abs(below_a / a.weight - below_b / b.weight);
    out.wasserstein += apart * gap, out.kolmogorov = std::max(out.kolmogorov, apart);
  }
  out.a = a.side(), out.b = b.side();
  out.cohens_d = effect(out.a, out.b);
  if (out.a.count > 1 && out.b.sd > 0) out.sd_ratio = out.a.sd / out.b.sd;
  return out;
}

double kolmogorov_p(double distance, double count_a, double count_b) {
  const double root = std::sqrt(count_a * count_b / (count_a + count_b));
  const double x = (root + 0.12 + 0.11 / root) * distance;
  if (x < 0.2) return 1.0; // the series does not converge there, and p is 1 to 1e-12
  double sum = 0;
  for (int j = 1; j <= 100; j++)
    sum += (j % 2 ? 2.0 : -2.0) * conceg_exp(-2.0 * j * j * x * x);
  return std::min(1.0, std::max(0.0, sum));
}

double quantile_of(std::vector<double> values, double at) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return undefined;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(at * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(1.0, rank)) - 1];
}

double mean_of_known(const std::vector<double> &values) {
  double sum = 0, count = 0;
  for (const double value : values)
    if (!std::isnan(value)) sum += value, count++;
  return count > 0 ? sum / count : undefined;
}

} // namespace conceg::analyse
