// SPDX-License-Identifier: BSD-3-Clause
#include "signals.hpp"

#include "conceg/portable.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::simulate {

namespace {

// Sum and sum of squares of deviations from a first guess, so that few digits are lost.
struct Sums {
  double first = 0.0, second = 0.0;
  void add(double x) { first += x, second += x * x; }
};
Mean mean_of(const Sums &s, double guess, double n) {
  if (!(n > 0.0)) return {};
  const double mean = s.first / n;
  return {guess + mean, n > 1.0 ? std::sqrt(std::max(0.0, s.second / n - mean * mean) / (n - 1.0)) : 0.0};
}

} // namespace

Signals mean_signals(const Protocol &protocol, const Walkers &walkers, const Compartment &compartment,
                     Workers &workers) {
  const std::size_t rows = protocol.measurements(), shapes = protocol.timeline.shapes;
  const std::vector<std::uint32_t> shell = shells(protocol);
  const std::size_t shell_count = shell.empty() ? 0 : 1 + *std::max_element(shell.begin(), shell.end());
  std::vector<std::vector<std::size_t>> member(shell_count);
  for (std::size_t r = 0; r < rows; r++)
    member[shell[r]].push_back(r);
  Signals out;
  out.real.resize(rows), out.imaginary.resize(rows), out.powder.resize(shell_count);
  const double n = static_cast<double>(compartment.walker.size());
  workers.loop(shell_count, 1, [&](std::size_t s, unsigned) {
    std::vector<Sums> real(member[s].size());
    std::vector<double> imaginary(member[s].size(), 0.0);
    Sums powder;
    for (const std::uint32_t w : compartment.walker) {
      const double weight = walkers.weight.empty() ? 1.0 : walkers.weight[w];
      double average = 0.0;
      for (std::size_t i = 0; i < member[s].size(); i++) {
        const glm::dvec3 *coefficient = &protocol.coefficient[member[s][i] * shapes];
        double phase = 0.0, sine = 0.0, cosine = 1.0;
        for (std::size_t k = 0; k < shapes; k++)
          phase += glm::dot(coefficient[k], walkers.vector[w * shapes + k]);
        conceg_sincos(phase, &sine, &cosine);
        real[i].add(weight * cosine - 1.0), imaginary[i] += weight * sine, average += weight * cosine - 1.0;
      }
      powder.add(average / static_cast<double>(member[s].size()));
    }
    for (std::size_t i = 0; i < member[s].size(); i++) {
      out.real[member[s][i]] = mean_of(real[i], 1.0, n);
      out.imaginary[member[s][i]] = n > 0.0 ? imaginary[i] / n : 0.0;
    }
    out.powder[s] = mean_of(powder, 1.0, n);
  });
  return out;
}

Spread spread_at(const Walkers &walkers, const Compartment &compartment, std::size_t time, double time_ms) {
  Spread out;
  const double n = static_cast<double>(compartment.walker.size());
  const glm::dvec3 *moved = &walkers.displacement[time * walkers.count];
  Sums squared;
  for (const std::uint32_t w : compartment.walker)
    squared.add(glm::dot(moved[w], moved[w]));
  out.msd = mean_of(squared, 0.0, n);
  for (int axis = 0; axis < 3; axis++) {
    Sums second, fourth;
    for (const std::uint32_t w : compartment.walker) {
      const double x2 = moved[w][axis] * moved[w][axis];
      second.add(x2), fourth.add(x2 * x2);
    }
    const Mean m2 = mean_of(second, 0.0, n);
    out.diffusivity[axis] = {m2.value / (2.0 * time_ms), m2.error / (2.0 * time_ms)};
    const double m4 = n > 0.0 ? fourth.first / n : 0.0;
    if (!(m2.value > 0.0)) continue;
    // By the delta method: the walker's influence on m4 / m2^2 is (x^4 - m4) / m2^2 - 2 m4 (x^2 - m2) / m2^3.
    Sums influence;
    for (const std::uint32_t w : compartment.walker) {
      const double x2 = moved[w][axis] * moved[w][axis];
      influence.add((x2 * x2 - m4) / (m2.value * m2.value) -
                    2.0 * m4 * (x2 - m2.value) / (m2.value * m2.value * m2.value));
    }
    out.kurtosis[axis] = {m4 / (m2.value * m2.value) - 3.0, mean_of(influence, 0.0, n).error};
  }
  return out;
}

} // namespace conceg::simulate
