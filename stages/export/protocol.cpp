// SPDX-License-Identifier: BSD-3-Clause
#include "protocol.hpp"

#include "guard.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace conceg::exporting {

std::vector<double> parse_b_values(const std::string &text) {
  std::vector<double> values;
  const char *at = text.data(), *end = at + text.size();
  while (at < end) {
    if (*at == ' ' || *at == ',') {
      at++;
      continue;
    }
    double value = -1.0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !(value >= 0.0 && value <= 1e4) || values.size() >= 1000)
      fail(CONCEG_E_PARAM,
           "b_values: expected at most 1000 numbers of 0 to 10000 ms/um2 such as \"0 1 2.5\", got \"%s\"",
           text.c_str());
    values.push_back(value), at = stop;
  }
  if (values.empty()) fail(CONCEG_E_PARAM, "b_values: expected at least one number, got none");
  return values;
}

std::vector<Measurement> measurements(const Protocol &protocol) {
  std::vector<Measurement> rows;
  const double golden = 3.14159265358979323846 * (3.0 - std::sqrt(5.0));
  for (const double b : protocol.b)
    for (int i = 0; i < (b > 0.0 ? protocol.directions : 1); i++) {
      const double z = (i + 0.5) / protocol.directions, r = std::sqrt(1.0 - z * z);
      rows.push_back({b, {r * std::cos(golden * i), r * std::sin(golden * i), z}});
    }
  return rows;
}

double gradient_t_per_m(const Protocol &protocol, double b, double gamma) {
  const double delta = protocol.pulse_ms * 1e-3, separation = protocol.separation_ms * 1e-3; // s
  return std::sqrt(b * 1e9 / (separation - delta / 3.0)) / (gamma * delta);
}

std::string scheme_text(const Protocol &protocol, double gamma) {
  std::string text = "VERSION: STEJSKALTANNER\n";
  char line[256];
  for (const Measurement &m : measurements(protocol)) {
    std::snprintf(line, sizeof line, "%.9f %.9f %.9f %.9f %.9g %.9g %.9g\n", m.direction.x, m.direction.y,
                  m.direction.z, gradient_t_per_m(protocol, m.b, gamma), protocol.separation_ms * 1e-3,
                  protocol.pulse_ms * 1e-3, protocol.echo_ms() * 1e-3);
    text += line;
  }
  return text;
}

} // namespace conceg::exporting
