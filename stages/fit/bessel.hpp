// SPDX-License-Identifier: BSD-3-Clause
// Roots of the derivatives of the spherical Bessel functions: the modes of diffusion in a reflecting sphere.
#pragma once

#include <vector>

namespace conceg::fit {

// Roots mu with j_l'(mu) = 0 and 0 < mu < `below`, ascending, to double precision.
std::vector<double> derivative_roots(unsigned l, double below);

} // namespace conceg::fit
