// SPDX-License-Identifier: BSD-3-Clause
// Direction averages of compartments with Gaussian diffusion, by x = b D: stick, ball and sheet.
#pragma once

#include "signal.hpp"

namespace conceg::fit {

// Neurites: D along an axis, none across it. sqrt(pi / (4 x)) erf(sqrt x).
Attenuation stick(double x);
// Extracellular space as published: D in all directions. exp(-x).
Attenuation ball(double x);
// Extracellular space between walls that are flat on the scale of diffusion: D along a plane, none across it.
// Dawson(sqrt x) / sqrt x.
Attenuation sheet(double x);

} // namespace conceg::fit
