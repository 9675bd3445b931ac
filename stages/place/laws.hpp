// SPDX-License-Identifier: BSD-3-Clause
// Exact draws from the laws of passing axons: a gamma law cut below, and Watson's law of directions.
#pragma once

#include "conceg/rng.h"

#include <glm/vec3.hpp>

namespace conceg::place {

// A gamma law by its mean and standard deviation, values below `minimum` drawn again. sd = 0: always the
// mean. Needs 0 <= sd <= mean (a shape of at least 1) and minimum <= mean.
struct GammaLaw {
  double mean, sd, minimum;
};
double draw_gamma(const GammaLaw &law, conceg_rng &rng);

// Watson's law, density ~ exp(kappa (axis . u)^2), kappa >= 0: an axis without sign; 0 = isotropic.
struct WatsonLaw {
  glm::dvec3 axis; // unit vector
  double kappa;
};
glm::dvec3 draw_direction(const WatsonLaw &law, conceg_rng &rng);

} // namespace conceg::place
