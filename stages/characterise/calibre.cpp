// SPDX-License-Identifier: BSD-3-Clause
#include "calibre.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <cmath>

namespace conceg::characterise {
namespace {

constexpr double step_um = 1.0;
constexpr std::size_t fewest_for_taper = 4, fewest_for_correlation = 10;
constexpr std::size_t fewest_for_verdict = 100; // samples, of a trace
constexpr double inverse_e = 0.36787944117144233;
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
  double previous = 1.0;
  for (std::size_t lag = 1; lag <= residual.size() / 2; lag++) {
    double sum = 0.0;
    for (std::size_t k = lag; k < residual.size(); k++)
      sum += residual[k] * residual[k - lag];
    const double value = sum / static_cast<double>(residual.size() - lag) / variance;
    if (value < inverse_e)
      return step_um * (static_cast<double>(lag - 1) + (previous - inverse_e) / (previous - value));
    previous = value;
  }
  return step_um * static_cast<double>(residual.size() / 2);
}

} // namespace

Calibre measure_calibre(const std::vector<double> &path, const std::vector<double> &radius,
                        std::vector<double> *given) {
  Calibre out;
  if (given) given->clear();
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
  if (given) *given = std::move(residual);
  return out;
}

const char *name_of(Trace trace) {
  static const char *const names[] = {"none", "continuous", "quantised", "constant"};
  return names[static_cast<int>(trace)];
}

Trace trace_of(std::vector<double> radii) {
  if (radii.empty()) return Trace::none;
  std::sort(radii.begin(), radii.end());
  std::size_t values = 0, most = 0, run = 0;
  for (std::size_t i = 0; i < radii.size(); i++) {
    run = i && radii[i] == radii[i - 1] ? run + 1 : 1;
    values += run == 1, most = std::max(most, run);
  }
  if (radii.size() < fewest_for_verdict) return Trace::continuous;
  return 2 * most > radii.size()      ? Trace::constant
         : 20 * values < radii.size() ? Trace::quantised
                                      : Trace::continuous;
}

void CalibrePool::add(const Calibre &bar, double length, const std::vector<double> &residual) {
  radius_sum_ += bar.radius * length, length_ += length;
  if (residual.size() < fewest_for_correlation) return; // what the taper leaves of a short bar says nothing
  for (std::size_t lag = 0; lag < std::min(lags, residual.size()); lag++)
    for (std::size_t k = lag; k < residual.size(); k++)
      sum_[lag] += residual[k] * residual[k - lag], count_[lag]++;
}

void CalibrePool::add(const CalibrePool &other) {
  radius_sum_ += other.radius_sum_, length_ += other.length_;
  for (std::size_t lag = 0; lag < lags; lag++)
    sum_[lag] += other.sum_[lag], count_[lag] += other.count_[lag];
}

double CalibrePool::radius() const {
  return length_ > 0.0 ? radius_sum_ / length_ : 0.0;
}

double CalibrePool::cv() const {
  return count_[0] > 0.0 ? std::sqrt(sum_[0] / count_[0]) : 0.0;
}

double CalibrePool::correlation_length() const {
  if (!(sum_[0] > 0.0)) return 0.0;
  const double variance = sum_[0] / count_[0];
  double previous = 1.0;
  std::size_t lag = 1;
  for (; lag < lags && count_[lag] > 0.0; lag++) {
    const double value = sum_[lag] / count_[lag] / variance;
    if (value < inverse_e)
      return step_um * (static_cast<double>(lag - 1) + (previous - inverse_e) / (previous - value));
    previous = value;
  }
  return step_um * static_cast<double>(lag - 1);
}

} // namespace conceg::characterise
