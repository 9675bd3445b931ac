// SPDX-License-Identifier: BSD-3-Clause
#include "walk.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::grow {

namespace {
// Straight lines between knots take (1 - exp(-1/16)) / 3 = 2 % off the variance at this many a correlation
// length.
constexpr double knots_per_length = 16.0;
constexpr double coarsest_um = 0.5; // half a step of growth
} // namespace

double first_value(conceg_rng &stream) {
  return conceg_rng_normal(&stream);
}

void Walk::draw(double first, double last, double correlation_length_um, double first_value,
                conceg_rng stream) {
  first_ = first;
  spacing_ = std::min(coarsest_um, correlation_length_um / knots_per_length);
  const double rho = conceg_exp(-spacing_ / correlation_length_um), rest = std::sqrt(1.0 - rho * rho);
  const auto knots = static_cast<std::size_t>(std::max(0.0, last - first) / spacing_) + 2;
  value_.resize(knots);
  double value = first_value;
  for (float &knot : value_) {
    knot = static_cast<float>(value);
    value = rho * value + rest * conceg_rng_normal(&stream);
  }
}

double Walk::at(double path) const {
  const double place = std::clamp((path - first_) / spacing_, 0.0, static_cast<double>(value_.size() - 1));
  const auto knot = std::min(static_cast<std::size_t>(place), value_.size() - 2);
  const double part = place - static_cast<double>(knot);
  return (1.0 - part) * static_cast<double>(value_[knot]) + part * static_cast<double>(value_[knot + 1]);
}

double Walk::largest(double from, double to) const {
  double most = std::max(at(from), at(to));
  const double last = static_cast<double>(value_.size() - 1);
  const auto begin = static_cast<std::size_t>(std::clamp((from - first_) / spacing_, 0.0, last));
  const auto end = static_cast<std::size_t>(std::clamp((to - first_) / spacing_, 0.0, last));
  for (std::size_t knot = begin + 1; knot <= end; knot++)
    most = std::max(most, static_cast<double>(value_[knot]));
  return most;
}

} // namespace conceg::grow
