// SPDX-License-Identifier: BSD-3-Clause
// Bounded non-linear least squares with plain arrays; Ceres stays behind it.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace conceg::fit {

struct LeastSquares {
  std::size_t residuals = 0;
  // A parameter whose bounds are equal is not fitted.
  std::vector<double> lower, upper;
  // Fills the residuals and, where it is not null, the Jacobian (residuals x parameters, row-major, all
  // parameters). Values are always within the bounds.
  std::function<void(const double *parameters, double *residuals, double *jacobian)> evaluate;
};

struct Minimum {
  std::vector<double> parameters;
  double cost = 0.0; // sum of squared residuals
  bool converged = false;
};

// Levenberg-Marquardt from a start within the bounds, on one thread: same start, same bytes.
Minimum minimise(const LeastSquares &problem, const std::vector<double> &start);

// Covariance of the marked parameters when the residuals vary independently with `variance` each: J+ V J+^T
// with the pseudo-inverse J+ of the Jacobian; zeros for the others. Empty when a marked parameter cannot be
// told from the rest.
std::vector<double> covariance(const LeastSquares &problem, const std::vector<double> &at,
                               const std::vector<bool> &marked, const std::vector<double> &variance);

} // namespace conceg::fit
