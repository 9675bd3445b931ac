// SPDX-License-Identifier: BSD-3-Clause
#include "gaussian.hpp"

#include "conceg/portable.h"

#include <cmath>

namespace conceg::fit {
namespace {

// Beyond this erf(sqrt x) is 1, and Dawson's function has its asymptotic series, to double precision.
constexpr double far = 60.0;
constexpr double quarter_pi = 0.78539816339744830962;

// A series of positive terms, so that nothing cancels: sum of t_n, t_0 = 1, t_{n+1} = t_n ratio(n).
template <class Ratio> double sum(Ratio &&ratio) {
  double term = 1.0, total = 1.0;
  for (int n = 0; term > 1e-17 * total; n++)
    total += term *= ratio(n);
  return total;
}

} // namespace

Attenuation stick(double x) {
  // e^-x (1 + 2x/3 + (2x)^2/15 + ...)
  const double value = x > far ? std::sqrt(quarter_pi / x)
                               : conceg_exp(-x) * sum([x](int n) { return 2.0 * x / (2 * n + 3); });
  // (e^-x - S) / (2 x), which tends to -1/3
  const double slope = x < 1e-4 ? -1.0 / 3.0 + 0.2 * x : (conceg_exp(-x) - value) / (2.0 * x);
  return {value, slope};
}

Attenuation ball(double x) {
  const double value = conceg_exp(-x);
  return {value, -value};
}

Attenuation sheet(double x) {
  // e^-x (1 + x/3 + x^2/(5 2!) + ...); beyond, (1 + 1/(2x) (1 + 3/(2x) (1 + 5/(2x) ...))) / (2x)
  double value;
  if (x > far) {
    value = 1.0;
    for (int n = 12; n > 0; n--)
      value = 1.0 + value * (2 * n - 1) / (2.0 * x);
    value /= 2.0 * x;
  } else
    value = conceg_exp(-x) * sum([x](int n) { return x * (2 * n + 1) / ((n + 1.0) * (2 * n + 3)); });
  // (1 - S (1 + 2x)) / (2 x), which tends to -2/3
  const double slope = x < 1e-4 ? -2.0 / 3.0 + 8.0 / 15.0 * x : (1.0 - value * (1.0 + 2.0 * x)) / (2.0 * x);
  return {value, slope};
}

} // namespace conceg::fit
