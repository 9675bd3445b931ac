// SPDX-License-Identifier: BSD-3-Clause
#include "sphere_gpd.hpp"

#include "bessel.hpp"
#include "conceg/portable.h"

#include <cmath>

namespace conceg::fit {

// The sum falls as mu^-6: 60 roots leave 1e-9 of it out.
SphereGpd::SphereGpd(const Timing &timing) : timing_(timing), roots_(derivative_roots(1, 189.0)) {}

// Lengths in units of sqrt D leave one variable: ADC(R, D) = D f(R / sqrt D). f and its slope.
SphereGpd::Reduced SphereGpd::reduced(double radius) const {
  const double d = timing_.delta_ms, del = timing_.separation_ms;
  Reduced f{0.0, 0.0};
  for (const double mu : roots_) {
    const double s = mu * mu / (radius * radius), weight = 1.0 / (s * s * s * (mu * mu - 2.0));
    const double e_d = conceg_exp(-s * d), e_del = conceg_exp(-s * del), e_minus = conceg_exp(-s * (del - d)),
                 e_plus = conceg_exp(-s * (del + d));
    const double bracket = 2.0 * s * d - 2.0 + 2.0 * e_d + 2.0 * e_del - e_minus - e_plus;
    const double by_s =
        2.0 * d - 2.0 * d * e_d - 2.0 * del * e_del + (del - d) * e_minus + (del + d) * e_plus;
    f.value += weight * bracket;
    f.slope += weight * (by_s - 3.0 * bracket / s) * (-2.0 * s / radius);
  }
  const double scale = 2.0 * timing_.squared_gradient(1.0);
  return {scale * f.value, scale * f.slope};
}

double SphereGpd::apparent(double radius_um, double diffusivity) const {
  return diffusivity * reduced(radius_um / std::sqrt(diffusivity)).value;
}

SphereSignal SphereGpd::operator()(double b, double radius_um, double diffusivity) const {
  const double root = std::sqrt(diffusivity), reduced_radius = radius_um / root;
  const Reduced f = reduced(reduced_radius);
  const double value = conceg_exp(-b * diffusivity * f.value);
  return {value, -b * value * root * f.slope, -b * value * (f.value - 0.5 * reduced_radius * f.slope)};
}

double SphereGpd::radius_of(double apparent_diffusivity, double diffusivity, double low_um,
                            double high_um) const {
  for (int i = 0; i < 60; i++) {
    const double middle = 0.5 * (low_um + high_um);
    (apparent(middle, diffusivity) < apparent_diffusivity ? low_um : high_um) = middle;
  }
  return 0.5 * (low_um + high_um);
}

} // namespace conceg::fit
