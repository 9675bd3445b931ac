// SPDX-License-Identifier: BSD-3-Clause
#include "calibre.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <cmath>

namespace conceg::characterise {
namespace {

constexpr double step_um = 1.0;
constexpr std::size_t fewest_for_taper = 4, fewest_for_correlation = 10;
constexpr double lowest_share = 0.1; // the tapered line is not taken below this share of the mean

// Radii every 1 um from the start, linear between the samples.
std::vector<double> resample(const std::vector<double> &path, const std::vector<double> &radius) {
  std::vector<double> out;
  std::size_t i = 1;
  for (std::size_t k = 0;; k++) {
    const double at = path.front() + step_um * static_cast<double>(k);
    if (at > path.back()) return out;
    while (i + 1 < path.size() && path[i] < at)
      i++;
    const double span = path[i] - path[i - 1];
    const double share = span > 0.0 ? std::clamp((at - path[i - 1]) / span, 0.0, 1.0) : 1.0;
    out.push_back(radius[i - 1] + share * (radius[i] - radius[i - 1]));
  }
}

double mean_radius(const std::vector<double> &path, const std::vector<double> &radius) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); i++)
    sum += 0.5 * (radius[i] + radius[i - 1]) * (path[i] - path[i - 1]);
  const double length = path.back() - path.front();
  return length > 0.0 ? sum / length : radius.back();
}

double slope(const std::vector<double> &value) {
  const double middle = 0.5 * static_cast<double>(value.size() - 1);
  double top = 0.0, bottom = 0.0;
  for (std::size_t k = 0; k < value.size(); k++) {
    const double x = static_cast<double>(k) - middle;
    top += x * value[k], bottom += x * x;
  }
  return top / bottom / step_um;
}

double correlation_length(const std::vector<double> &residual, double variance) {
  const double threshold = 0.36787944117144233;
  double previous = 1.0;
  for (std::size_t lag = 1; lag <= residual.size() / 2; lag++) {
    double sum = 0.0;
    for (std::size_t k = lag; k < residual.size(); k++)
      sum += residual[k] * residual[k - lag];
    const double value = sum / static_cast<double>(residual.size() - lag) / variance;
    if (value < threshold)
      return step_um * (static_cast<double>(lag - 1) + (previous - threshold) / (previous - value));
    previous = value;
  }
  return step_um * static_cast<double>(residual.size() / 2);
}

} // namespace

Calibre measure_calibre(const std::vector<double> &path, const std::vector<double> &radius) {
  Calibre out;
  if (path.empty()) return out;
  out.radius = mean_radius(path, radius);
  if (path.size() < 2) return out;
  const std::vector<double> even = resample(path, radius);
  if (even.size() < fewest_for_taper) return out;
  out.taper = slope(even);

  double mean = 0.0;
  for (double r : even)
    mean += r / static_cast<double>(even.size());
  std::vector<double> residual(even.size());
  double offset = 0.0, variance = 0.0;
  for (std::size_t k = 0; k < even.size(); k++) {
    const double x = step_um * (static_cast<double>(k) - 0.5 * static_cast<double>(even.size() - 1));
    residual[k] = conceg_log(even[k]) - conceg_log(std::max(mean + out.taper * x, lowest_share * mean));
    offset += residual[k] / static_cast<double>(even.size());
  }
  for (double &r : residual)
    r -= offset, variance += r * r / static_cast<double>(even.size());
  out.cv = std::sqrt(variance);
  if (even.size() >= fewest_for_correlation && variance > 0.0)
    out.correlation_length = correlation_length(residual, variance);
  return out;
}

} // namespace conceg::characterise
