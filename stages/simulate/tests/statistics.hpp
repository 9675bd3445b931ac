// SPDX-License-Identifier: BSD-3-Clause
// Means of correlated values held against what they should be.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace conceg::simulate::testing {

struct ChiSquare {
  double value = 0.0;
  std::size_t degrees = 0;
  void add(const ChiSquare &other) { value += other.value, degrees += other.degrees; }
  // Chance of a larger value: the regularised incomplete gamma function Q(k/2, x/2), by series or fraction.
  double p() const {
    const double a = 0.5 * static_cast<double>(degrees), x = 0.5 * value;
    if (!(x > 0.0) || degrees == 0) return 1.0;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1.0) {
      double term = 1.0 / a, sum = term;
      for (int n = 1; n < 1000; n++)
        term *= x / (a + n), sum += term;
      return 1.0 - front * sum;
    }
    double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
    for (int n = 1; n < 1000; n++) {
      const double an = -n * (n - a);
      b += 2.0, d = 1.0 / (an * d + b), c = b + an / c, h *= c * d;
    }
    return front * h;
  }
};

struct Deviation {
  std::vector<double> mean, error, z;
  ChiSquare chi2;
};

// Rows of samples (one per walker) against expected means. The chi-square takes the samples' covariance into
// account (Hotelling), by Cholesky decomposition of the correlation matrix; values that the ones before
// determine to 1e-2 of their variance are left out of it.
inline Deviation deviation(const std::vector<std::vector<double>> &sample,
                           const std::vector<double> &expected) {
  const std::size_t n = sample.size(), k = expected.size();
  Deviation out;
  out.mean.assign(k, 0.0), out.error.assign(k, 0.0), out.z.assign(k, 0.0);
  for (const auto &row : sample)
    for (std::size_t i = 0; i < k; i++)
      out.mean[i] += row[i] / static_cast<double>(n);
  std::vector<std::vector<double>> cov(k, std::vector<double>(k, 0.0));
  for (const auto &row : sample)
    for (std::size_t i = 0; i < k; i++)
      for (std::size_t j = 0; j < k; j++)
        cov[i][j] += (row[i] - out.mean[i]) * (row[j] - out.mean[j]) / static_cast<double>(n - 1) /
                     static_cast<double>(n);
  for (std::size_t i = 0; i < k; i++) {
    out.error[i] = std::sqrt(cov[i][i]);
    out.z[i] = out.error[i] > 0.0 ? (out.mean[i] - expected[i]) / out.error[i] : 0.0;
  }
  std::vector<std::vector<double>> factor;
  std::vector<std::size_t> kept;
  std::vector<double> solved;
  for (std::size_t i = 0; i < k; i++) {
    if (!(out.error[i] > 0.0)) continue;
    std::vector<double> row;
    double left = 1.0, value = out.z[i];
    for (std::size_t a = 0; a < kept.size(); a++) {
      double x = cov[i][kept[a]] / out.error[i] / out.error[kept[a]];
      for (std::size_t b = 0; b < a; b++)
        x -= row[b] * factor[a][b];
      x /= factor[a][a];
      row.push_back(x), left -= x * x, value -= x * solved[a];
    }
    if (left < 1e-2) continue;
    row.push_back(std::sqrt(left));
    solved.push_back(value / row.back());
    factor.push_back(row), kept.push_back(i);
    out.chi2.value += solved.back() * solved.back(), out.chi2.degrees++;
  }
  return out;
}

} // namespace conceg::simulate::testing
