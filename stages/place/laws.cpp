// SPDX-License-Identifier: BSD-3-Clause
#include "laws.hpp"

#include <glm/geometric.hpp>

#include <cmath>

namespace conceg::place {
namespace {

constexpr double kTwoPi = 6.28318530717958647693;
constexpr double kIsotropic = 1e-9; // a smaller kappa changes no density by more than that

// Gamma of a shape of at least 1 and scale 1 (Marsaglia and Tsang 2000).
double draw_standard_gamma(double shape, conceg_rng &rng) {
  const double d = shape - 1.0 / 3.0, c = 1.0 / std::sqrt(9.0 * d);
  for (;;) {
    const double x = conceg_rng_normal(&rng), cube_root = 1.0 + c * x, u = 1.0 - conceg_rng_uniform(&rng);
    if (!(cube_root > 0.0)) continue;
    const double v = cube_root * cube_root * cube_root;
    if (conceg_log(u) < 0.5 * x * x + d - d * v + d * conceg_log(v)) return d * v;
  }
}

// |cosine| to the axis, density ~ exp(kappa t^2) on [0, 1]: drawn below exp(kappa t), which is nowhere
// smaller, and kept with probability exp(kappa t^2 - kappa t) (Best and Fisher 1986); at least every second
// is.
double draw_cosine(double kappa, conceg_rng &rng) {
  if (kappa < kIsotropic) return conceg_rng_uniform(&rng);
  const double least = conceg_exp(-kappa);
  for (;;) {
    const double u = 1.0 - conceg_rng_uniform(&rng);
    const double t = 1.0 + conceg_log(u + (1.0 - u) * least) / kappa;
    if (conceg_rng_uniform(&rng) < conceg_exp(kappa * t * (t - 1.0))) return t;
  }
}

} // namespace

double draw_gamma(const GammaLaw &law, conceg_rng &rng) {
  if (law.sd == 0.0) return law.mean;
  const double shape = (law.mean / law.sd) * (law.mean / law.sd), scale = law.mean / shape;
  for (;;) {
    const double value = scale * draw_standard_gamma(shape, rng);
    if (value >= law.minimum) return value;
  }
}

glm::dvec3 draw_direction(const WatsonLaw &law, conceg_rng &rng) {
  double cosine = draw_cosine(law.kappa, rng);
  const double sine = std::sqrt(std::fmax(0.0, 1.0 - cosine * cosine));
  if (conceg_rng_below(&rng, 2) == 1) cosine = -cosine;
  double sine_azimuth, cosine_azimuth;
  conceg_sincos(kTwoPi * conceg_rng_uniform(&rng), &sine_azimuth, &cosine_azimuth);
  const glm::dvec3 aside = std::fabs(law.axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(law.axis, aside)), v = glm::cross(law.axis, u);
  return cosine * law.axis + sine * (cosine_azimuth * u + sine_azimuth * v);
}

} // namespace conceg::place
