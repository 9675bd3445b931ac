// SPDX-License-Identifier: BSD-3-Clause
// Signal of a reflecting sphere by the Gaussian phase distribution, as SANDI was published.
#pragma once

#include "signal.hpp"

#include <vector>

namespace conceg::fit {

// Murday & Cotts 1968, Neuman 1974:
//   ln S = -2 (gamma G)^2 sum_m [2 a^2 D d - 2 + 2 e^{-a^2 D d} + 2 e^{-a^2 D Del} - e^{-a^2 D (Del - d)}
//          - e^{-a^2 D (Del + d)}] / (D^2 a^6 (mu_m^2 - 2)),   a = mu_m / R, j_1'(mu_m) = 0.
class SphereGpd {
public:
  explicit SphereGpd(const Timing &timing);
  // b in ms/um^2, radius in um, diffusivity in um^2/ms, all above 0 (b may be 0).
  SphereSignal operator()(double b, double radius_um, double diffusivity) const;
  // The apparent diffusivity, -ln S / b.
  double apparent(double radius_um, double diffusivity) const;
  // The radius whose apparent diffusivity is `apparent` (it grows with the radius), between low and high.
  double radius_of(double apparent_diffusivity, double diffusivity, double low_um, double high_um) const;

private:
  struct Reduced {
    double value, slope;
  };
  Reduced reduced(double radius) const;
  Timing timing_;
  std::vector<double> roots_;
};

} // namespace conceg::fit
