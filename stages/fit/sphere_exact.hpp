// SPDX-License-Identifier: BSD-3-Clause
// Signal of a reflecting sphere, exact: the matrix method (multiple correlation functions).
#pragma once

#include "signal.hpp"

#include <cstdint>
#include <vector>

namespace conceg::fit {

// Eigenmodes of the unit sphere that a gradient along z couples to the uniform one (m = 0), with mu below a
// limit, and the matrix of z between them, which joins modes l and l + 1 alone.
struct SphereModes {
  // 36 gives 171 modes and the signal to 1e-7 up to gamma G R^3 / D = 1000.
  explicit SphereModes(double below = 36.0);
  std::vector<double> mu;
  std::vector<unsigned> order; // l
  std::vector<double> z;       // mu.size() squared, row-major
};

// Callaghan 1997, Grebenkov 2007:
//   S = [e^{-(L - iqB) d} e^{-L (Del - d)} e^{-(L + iqB) d}]_00,  L = diag(D mu^2 / R^2), q = gamma G R.
// B couples even and odd l alone, so phases i^l make it real: with w' = -(L + q K) w, w(0) = e_0,
// K_jk = +B_jk for l_j > l_k and -B_jk otherwise, S = sum_k w_k(d)^2 e^{-L_k (Del - d)}, which is never
// negative.
double sphere_exact(const SphereModes &modes, const Timing &timing, double b, double radius_um,
                    double diffusivity);

} // namespace conceg::fit
