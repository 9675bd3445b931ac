// SPDX-License-Identifier: BSD-3-Clause
#include "bessel.hpp"

#include <cmath>

namespace conceg::fit {
namespace {

// A positive multiple of j_l'(x) for x > 0, by Miller's downward recurrence, which begins where j is
// positive; the sum of (2 l + 1) j_l^2 is 1.
double derivative(unsigned l, double x) {
  const unsigned start = static_cast<unsigned>(x) + l + 40;
  double above = 0.0, here = 1e-200, squares = 0.0, wanted = 0.0, next = 0.0;
  for (unsigned order = start;; order--) {
    squares += (2.0 * order + 1.0) * here * here;
    if (order == l + 1) next = here;
    if (order == l) wanted = here;
    if (order == 0) break;
    const double below = (2.0 * order + 1.0) / x * here - above;
    above = here, here = below;
    if (std::fabs(here) > 1e100) {
      here *= 1e-100, above *= 1e-100, next *= 1e-100, wanted *= 1e-100, squares *= 1e-200;
    }
  }
  return (l / x * wanted - next) / std::sqrt(squares);
}

double bisect(unsigned l, double low, double high) {
  const bool rises = derivative(l, low) < 0.0;
  for (int i = 0; i < 60; i++) {
    const double middle = 0.5 * (low + high);
    (((derivative(l, middle) < 0.0) == rises) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

} // namespace

std::vector<double> derivative_roots(unsigned l, double below) {
  // Roots of one order lie further apart than this.
  constexpr double step = 0.25;
  std::vector<double> roots;
  double low = step, at_low = derivative(l, low);
  for (double high = low + step; low < below; low = high, high += step) {
    const double at_high = derivative(l, high);
    if ((at_low < 0.0) != (at_high < 0.0)) {
      const double root = bisect(l, low, high);
      if (root < below) roots.push_back(root);
    }
    at_low = at_high;
  }
  return roots;
}

} // namespace conceg::fit
