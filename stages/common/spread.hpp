// SPDX-License-Identifier: BSD-3-Clause
// What moved how far: means over walkers with standard errors, diffusivity and kurtosis by a time.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace conceg {

struct Mean {
  double value = 0.0, error = 0.0; // of the mean: sd / sqrt(n)
};

// Sum and sum of squares of deviations from a first guess, so that few digits are lost.
struct Sums {
  double first = 0.0, second = 0.0;
  void add(double x) { first += x, second += x * x; }
};
inline Mean mean_of(const Sums &s, double guess, double n) {
  if (!(n > 0.0)) return {};
  const double mean = s.first / n;
  return {guess + mean, n > 1.0 ? std::sqrt(std::max(0.0, s.second / n - mean * mean) / (n - 1.0)) : 0.0};
}

struct Spread {
  Mean msd;            // um^2
  Mean diffusivity[3]; // um^2/ms, along each axis: <x^2> / (2 t)
  Mean kurtosis[3];    // <x^4> / <x^2>^2 - 3
  Mean mean_kurtosis;  // over the axes
};

// `moved`: displacements (um) of all walkers after time_ms; `walker`: those that are averaged.
inline Spread spread_of(const glm::dvec3 *moved, const std::vector<std::uint32_t> &walker, double time_ms) {
  Spread out;
  const double n = static_cast<double>(walker.size());
  Sums squared;
  for (const std::uint32_t w : walker)
    squared.add(glm::dot(moved[w], moved[w]));
  out.msd = mean_of(squared, 0.0, n);
  glm::dvec3 square(0.0), fourth(0.0);
  for (int axis = 0; axis < 3; axis++) {
    Sums second, powers;
    for (const std::uint32_t w : walker) {
      const double x2 = moved[w][axis] * moved[w][axis];
      second.add(x2), powers.add(x2 * x2);
    }
    const Mean m2 = mean_of(second, 0.0, n);
    out.diffusivity[axis] = {m2.value / (2.0 * time_ms), m2.error / (2.0 * time_ms)};
    square[axis] = m2.value, fourth[axis] = n > 0.0 ? powers.first / n : 0.0;
  }
  // By the delta method: a walker's influence on m4 / m2^2 is (x^4 - m4) / m2^2 - 2 m4 (x^2 - m2) / m2^3.
  const auto influence = [&](std::uint32_t w, int axis) {
    const double x2 = moved[w][axis] * moved[w][axis], m2 = square[axis], m4 = fourth[axis];
    return (x2 * x2 - m4) / (m2 * m2) - 2.0 * m4 * (x2 - m2) / (m2 * m2 * m2);
  };
  bool all = true;
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    if (!(square[axis] > 0.0)) {
      all = false;
      continue;
    }
    Sums own;
    for (const std::uint32_t w : walker)
      own.add(influence(w, axis));
    out.kurtosis[axis] = {fourth[axis] / (square[axis] * square[axis]) - 3.0, mean_of(own, 0.0, n).error};
    sum += out.kurtosis[axis].value;
  }
  if (!all) return out;
  Sums together;
  for (const std::uint32_t w : walker)
    together.add((influence(w, 0) + influence(w, 1) + influence(w, 2)) / 3.0);
  out.mean_kurtosis = {sum / 3.0, mean_of(together, 0.0, n).error};
  return out;
}

} // namespace conceg
