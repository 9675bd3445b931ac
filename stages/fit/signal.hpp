// SPDX-License-Identifier: BSD-3-Clause
// What a compartment's signal is to a fit: its value and its derivatives.
#pragma once

namespace conceg::fit {

// Pulsed gradient spin echo with rectangular pulses: length of a pulse and time between their beginnings.
struct Timing {
  double delta_ms = 5.0, separation_ms = 20.0;
  // b = (gamma G)^2 delta^2 (Delta - delta / 3)
  double squared_gradient(double b) const {
    return b / (delta_ms * delta_ms * (separation_ms - delta_ms / 3.0));
  }
};

// A signal of b D alone, and its derivative by b D.
struct Attenuation {
  double value = 1.0, slope = 0.0;
};

// A sphere's signal and its derivatives by its radius and by the diffusivity inside.
struct SphereSignal {
  double value = 1.0, by_radius = 0.0, by_diffusivity = 0.0;
};

} // namespace conceg::fit
