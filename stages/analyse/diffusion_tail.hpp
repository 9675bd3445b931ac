// SPDX-License-Identifier: BSD-3-Clause
// How D(t) = <x^2> / (2 t) ends: its limit and its structural exponent (Novikov et al. 2014), with errors.
#pragma once

#include "spread.hpp"

#include <string>
#include <vector>

namespace conceg::analyse {

// D at several times, of the same walkers, so that its values are correlated.
struct DiffusivityCurve {
  std::vector<double> time;       // ms, ascending
  std::vector<double> value;      // um^2/ms
  std::vector<double> covariance; // [times][times], of the means, (um^2/ms)^2
  std::size_t walkers = 0;        // that the covariance is estimated from; 0 = it is known
};

inline constexpr int mean_axis = 3; // <r^2> / (6 t)

// `moved`[i] points to the displacements (um) of all walkers after time[i]; axis 0 to 2, or mean_axis.
DiffusivityCurve diffusivity_curve(const std::vector<const glm::dvec3 *> &moved,
                                   const std::vector<double> &time, const std::vector<std::uint32_t> &walker,
                                   int axis);

// D(t) = limit + amplitude (t / 1 ms)^-exponent.
struct Tail {
  std::string state; // fitted; rejected (chi2 beyond 1 in 1000); or void: why
  Mean limit, amplitude, exponent;
  double chi2 = 0.0;
  std::size_t degrees = 0;
  bool is_fitted() const { return state == "fitted"; }
};

// Generalised least squares with the curve's whole covariance. `exponent` 0 = fitted too. Void where times
// are too few or too close (less than a factor of 3) or walkers fewer than ten a time, where D does not
// depend on time or follows no such law within exponents of 0.05 to 3, where exponent or limit are hardly
// known (errors above 0.5, above D at the end), where the limit would be negative, or D is still more than
// twice its limit: the walk is too short. Void tails have zeros.
Tail fit_tail(const DiffusivityCurve &curve, double exponent);

} // namespace conceg::analyse
