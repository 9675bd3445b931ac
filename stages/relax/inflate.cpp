// SPDX-License-Identifier: BSD-3-Clause
#include "inflate.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace conceg::relax {

namespace {

// Sums over the segments of a class, weighted by length and by volume.
struct Sums {
  double length = 0, radius = 0, volume = 0, first = 0, second = 0;
  void add(double l, double r) {
    const double v = l * r * r;
    length += l, radius += l * r, volume += v, first += v * r, second += v * r * r;
  }
  double mean() const { return length > 0 ? radius / length : 0; }
  double cv() const {
    if (!(volume > 0)) return 0;
    const double m = first / volume;
    return std::sqrt(std::max(0.0, second / volume - m * m)) / m;
  }
};

} // namespace

std::vector<ClassRadii> class_radii(const Bodies &bodies, const std::vector<double> &radius,
                                    const std::vector<double> &target,
                                    const std::vector<std::uint32_t> &class_of, std::size_t classes) {
  std::vector<Sums> now(classes), asked(classes);
  for (std::size_t i = 0; i < bodies.points; i++) {
    if (bodies.parent[i] < 0) continue;
    const auto parent = static_cast<std::size_t>(bodies.parent[i]);
    const std::uint32_t k = class_of[bodies.elements[i].cell];
    const double length = glm::distance(bodies.position[i], bodies.position[parent]);
    now[k].add(length, 0.5 * (radius[i] + radius[parent]));
    asked[k].add(length, 0.5 * (target[i] + target[parent]));
  }
  std::vector<ClassRadii> out(classes);
  for (std::size_t k = 0; k < classes; k++)
    out[k] = {now[k].mean(), asked[k].mean(), now[k].cv(), asked[k].cv()};
  return out;
}

std::vector<double> inflated(const Bodies &bodies, const std::vector<double> &radius, double c) {
  std::vector<double> out = radius;
  for (std::size_t i = 0; i < bodies.points; i++) {
    const double most = largest_inflation * radius[i];
    out[i] += std::clamp(c, -most, most);
    if (c < 0) out[i] = std::max(out[i], std::min(radius[i], bodies.floor[i]));
  }
  return out;
}

namespace {

// The largest radius change that any point allows.
double most_change(const Bodies &bodies, const std::vector<double> &radius) {
  double most = 0;
  for (std::size_t i = 0; i < bodies.points; i++)
    most = std::max(most, largest_inflation * radius[i]);
  return most;
}

// Between which two c of [0, high] it changes from fits to does not fit.
template <class Fits> std::pair<double, double> bisect(double high, const Fits &fits) {
  constexpr int halvings = 20;
  double low = 0;
  for (int n = 0; n < halvings; n++) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return {low, high};
}

} // namespace

Inflation inflate_to(const Bodies &bodies, const std::vector<double> &radius,
                     const std::vector<double> &target, const std::vector<std::uint32_t> &class_of,
                     std::size_t classes, const glm::dvec3 &side, const Sample &sample, double gap,
                     double asked, const Tolerance &tolerance, Workers &workers) {
  const auto fraction = [&](double c) {
    return fractions_of(bodies, inflated(bodies, radius, c), side, sample, gap, workers).planes;
  };
  const auto radii_at = [&](double c) {
    return class_radii(bodies, inflated(bodies, radius, c), target, class_of, classes);
  };
  const std::vector<ClassRadii> before = radii_at(0);
  Inflation out;
  const auto too_far = [&](double c) { // says in `out` what stops it
    const std::vector<ClassRadii> all = radii_at(c);
    for (std::size_t k = 0; k < classes; k++) {
      const double cv = std::abs(all[k].cv_ratio() - 1), cv_before = std::abs(before[k].cv_ratio() - 1);
      const bool mean = all[k].mean_ratio() > 1 + tolerance.mean;
      if (!mean && !(cv > std::max(tolerance.cv, cv_before + 1e-9))) continue;
      out.stop = mean ? Inflation::Stop::mean : Inflation::Stop::cv, out.of_class = k;
      return true;
    }
    return false;
  };
  out.fraction = fraction(0);
  if (out.fraction >= asked) return out;
  const double most = most_change(bodies, radius);
  out.c = most, out.stop = Inflation::Stop::quarter;
  if (fraction(most) >= asked) {
    out.c = bisect(most, [&](double c) { return fraction(c) < asked; }).second;
    out.stop = Inflation::Stop::none;
  }
  if (too_far(out.c)) {
    const auto [low, high] = bisect(out.c, [&](double c) { return !too_far(c); });
    too_far(high);
    out.c = low;
  }
  out.fraction = fraction(out.c);
  return out;
}

Inflation deflate_to(const Bodies &bodies, const std::vector<double> &radius, const glm::dvec3 &side,
                     const Sample &sample, double gap, double asked, Workers &workers) {
  const auto fraction = [&](double c) {
    return fractions_of(bodies, inflated(bodies, radius, -c), side, sample, gap, workers).planes;
  };
  Inflation out;
  out.fraction = fraction(0);
  if (out.fraction <= asked) return out;
  const double most = most_change(bodies, radius);
  const bool reaches = fraction(most) <= asked;
  const double c = reaches ? bisect(most, [&](double less) { return fraction(less) > asked; }).second : most;
  out.c = -c, out.stop = reaches ? Inflation::Stop::none : Inflation::Stop::quarter;
  out.fraction = fraction(c);
  return out;
}

} // namespace conceg::relax
