// SPDX-License-Identifier: BSD-3-Clause
#include "sphere_table.hpp"

#include "sphere_exact.hpp"

#include "conceg/portable.h"

#include <cmath>

namespace conceg::fit {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double tolerance = 1e-8;
constexpr std::size_t most_nodes = 160;

// T_0 .. T_{n-1} at u, and their derivatives.
struct Polynomials {
  Polynomials(double u, std::size_t n) : value(n, 1.0), slope(n, 0.0) {
    double second = 1.0; // U_{k-1}, of the second kind: T_k' = k U_{k-1}
    double before = 0.0;
    for (std::size_t k = 1; k < n; k++) {
      value[k] = k == 1 ? u : 2.0 * u * value[k - 1] - value[k - 2];
      slope[k] = static_cast<double>(k) * second;
      const double next = 2.0 * u * second - before;
      before = second, second = next;
    }
  }
  std::vector<double> value, slope;
};

// Values at the nodes -> coefficients, along one side: stride between neighbours.
void transform(double *first, std::size_t n, std::size_t stride) {
  std::vector<double> out(n, 0.0);
  for (std::size_t k = 0; k < n; k++) {
    for (std::size_t i = 0; i < n; i++)
      out[k] += first[i * stride] *
                conceg_cos(pi * static_cast<double>(k * (2 * i + 1) % (4 * n)) / static_cast<double>(2 * n));
    out[k] *= (k ? 2.0 : 1.0) / static_cast<double>(n);
  }
  for (std::size_t k = 0; k < n; k++)
    first[k * stride] = out[k];
}

} // namespace

double SphereTable::Side::node(std::size_t i) const {
  const double u = conceg_cos(pi * (2.0 * static_cast<double>(i) + 1.0) / (2.0 * static_cast<double>(nodes)));
  return 0.5 * (low + high) + 0.5 * (high - low) * u;
}

SphereTable::SphereTable(const Timing &timing, const SphereRange &range, Workers &workers,
                         const Progress &progress)
    : strength_{0.0, range.b * range.diffusivity_high, 20}, radius_{range.radius_low /
                                                                        std::sqrt(range.diffusivity_high),
                                                                    range.radius_high /
                                                                        std::sqrt(range.diffusivity_low),
                                                                    24} {
  for (;;) {
    fill(timing, workers, progress);
    const bool more_strength = tail(false) > tolerance, more_radius = tail(true) > tolerance;
    if (!more_strength && !more_radius) return;
    if (more_strength) strength_.nodes += strength_.nodes / 2;
    if (more_radius) radius_.nodes += radius_.nodes / 2;
    if (strength_.nodes > most_nodes || radius_.nodes > most_nodes)
      fail(CONCEG_E_UNSUPPORTED,
           "kernel exact: radii of %g to %g um at b up to %g ms/um^2 need too large a table; lower "
           "radius_max_um or leave the largest b out",
           range.radius_low, range.radius_high, range.b);
  }
}

void SphereTable::fill(const Timing &timing, Workers &workers, const Progress &progress) {
  const SphereModes modes;
  const std::size_t count = strength_.nodes * radius_.nodes;
  coefficient_.assign(count, 0.0);
  for (std::size_t row = 0; row < strength_.nodes; row++) {
    report(progress, "exact signals of spheres", row, strength_.nodes);
    workers.loop(radius_.nodes, 1, [&](std::size_t column, unsigned) {
      coefficient_[row * radius_.nodes + column] =
          sphere_exact(modes, timing, strength_.node(row), radius_.node(column), 1.0);
    });
  }
  for (std::size_t row = 0; row < strength_.nodes; row++)
    transform(&coefficient_[row * radius_.nodes], radius_.nodes, 1);
  for (std::size_t column = 0; column < radius_.nodes; column++)
    transform(&coefficient_[column], strength_.nodes, radius_.nodes);
}

// The largest of the last two coefficients along one side.
double SphereTable::tail(bool of_radius) const {
  double most = 0.0;
  for (std::size_t i = 0; i < strength_.nodes; i++)
    for (std::size_t k = 0; k < radius_.nodes; k++)
      if ((of_radius ? k + 2 >= radius_.nodes : i + 2 >= strength_.nodes))
        most = std::max(most, std::fabs(coefficient_[i * radius_.nodes + k]));
  return most;
}

SphereSignal SphereTable::operator()(double b, double radius_um, double diffusivity) const {
  if (!(b > 0.0)) return {};
  const double root = std::sqrt(diffusivity), width = strength_.high - strength_.low,
               length = radius_.high - radius_.low, reduced_radius = radius_um / root;
  const Polynomials x(2.0 * (b * diffusivity - strength_.low) / width - 1.0, strength_.nodes),
      r(2.0 * (reduced_radius - radius_.low) / length - 1.0, radius_.nodes);
  double value = 0.0, by_x = 0.0, by_r = 0.0;
  for (std::size_t i = 0; i < strength_.nodes; i++) {
    const double *row = &coefficient_[i * radius_.nodes];
    double along = 0.0, slope = 0.0;
    for (std::size_t k = 0; k < radius_.nodes; k++)
      along += row[k] * r.value[k], slope += row[k] * r.slope[k];
    value += x.value[i] * along, by_x += x.slope[i] * along, by_r += x.value[i] * slope;
  }
  by_x *= 2.0 / width, by_r *= 2.0 / length;
  return {value, by_r / root, b * by_x - 0.5 * reduced_radius / diffusivity * by_r};
}

} // namespace conceg::fit
