// SPDX-License-Identifier: BSD-3-Clause
#include "inflate.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

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
  for (std::size_t i = 0; i < bodies.points; i++)
    out[i] += std::min(c, largest_inflation * radius[i]);
  return out;
}

Inflation inflate_to(const Bodies &bodies, const std::vector<double> &radius,
                     const std::vector<double> &target, const std::vector<std::uint32_t> &class_of,
                     std::size_t classes, const glm::dvec3 &side, const Sample &sample, double gap,
                     double asked, double mean_tolerance, Workers &workers) {
  constexpr int halvings = 20;
  const auto fraction = [&](double c) {
    return fractions_of(bodies, inflated(bodies, radius, c), side, sample, gap, workers).planes;
  };
  const auto too_wide = [&](double c) { // 1 + class, 0 = none
    const std::vector<ClassRadii> all =
        class_radii(bodies, inflated(bodies, radius, c), target, class_of, classes);
    for (std::size_t k = 0; k < classes; k++)
      if (all[k].mean_ratio() > 1 + mean_tolerance) return k + 1;
    return std::size_t{0};
  };
  Inflation out;
  out.fraction = fraction(0);
  if (out.fraction >= asked) return out;
  double most = 0;
  for (std::size_t i = 0; i < bodies.points; i++)
    most = std::max(most, largest_inflation * radius[i]);
  out.stop = 1;
  if (const std::size_t first = too_wide(most)) {
    double low = 0, high = most;
    out.stop = 1 + first;
    for (int n = 0; n < halvings; n++) {
      const double middle = 0.5 * (low + high);
      if (const std::size_t k = too_wide(middle))
        high = middle, out.stop = 1 + k;
      else
        low = middle;
    }
    most = low;
  }
  out.c = most, out.fraction = fraction(most);
  if (out.fraction < asked) return out;
  double low = 0, high = most;
  for (int n = 0; n < halvings; n++) {
    const double middle = 0.5 * (low + high);
    (fraction(middle) >= asked ? high : low) = middle;
  }
  return {high, fraction(high), 0};
}

} // namespace conceg::relax
