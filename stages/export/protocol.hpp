// SPDX-License-Identifier: BSD-3-Clause
// The pulsed-gradient protocol that goes along with a substrate, and the text forms that simulators read.
#pragma once

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace conceg::exporting {

// Gyromagnetic ratio of the proton as each consumer has it, rad/s/T: the same b takes another gradient in
// each.
inline constexpr double gamma_mcdc = 267.51525e6, gamma_disimpy = 267.513e6,
                        gamma_camino_schemes = 267.5987e6;

struct Protocol {
  std::vector<double> b; // ms/um2, 0 among them or not
  int directions = 0;
  double pulse_ms = 0.0, separation_ms = 0.0; // delta, Delta: from start to start
  double echo_ms() const {
    return separation_ms + pulse_ms + 1.0;
  } // the last step is not integrated by MC/DC
};
// One measurement: b in ms/um2 and a unit direction, which b = 0 has too.
struct Measurement {
  double b;
  glm::dvec3 direction;
};

// "0 1 2.5" or "0,1,2.5"; E_PARAM otherwise.
std::vector<double> parse_b_values(const std::string &text);
// All directions of a b value, then the next; b = 0 once. Directions: a spiral over the half sphere.
std::vector<Measurement> measurements(const Protocol &protocol);
// |G| in T/m of b in ms/um2: b = gamma^2 G^2 delta^2 (Delta - delta / 3).
double gradient_t_per_m(const Protocol &protocol, double b, double gamma);
// Camino's STEJSKALTANNER scheme: "gx gy gz |G| Delta delta TE" in T/m and s.
std::string scheme_text(const Protocol &protocol, double gamma);

} // namespace conceg::exporting
