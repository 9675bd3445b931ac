// SPDX-License-Identifier: BSD-3-Clause
// What is measured: gradients as shapes in time, shared by measurements, times a vector per measurement.
#pragma once

#include "walk.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <string>
#include <vector>

namespace conceg::simulate {

struct Protocol {
  std::vector<double> b;                                // ms/um^2
  std::vector<glm::dvec3> direction;                    // unit; any where b is 0
  std::vector<double> pulse_duration, pulse_separation; // ms; 0 = not a pair of pulses
  std::vector<double> echo_time;                        // ms
  std::vector<std::array<double, 6>> b_tensor;          // xx yy zz xy xz yz, ms/um^2
  std::vector<glm::dvec3> coefficient;                  // [measurements][shapes], rad/um/ms
  Timeline timeline;
  std::size_t measurements() const { return b.size(); }
};

// One pair of pulses.
struct Pulses {
  double b = 0.0; // ms/um^2
  glm::dvec3 direction = {1.0, 0.0, 0.0};
  double duration_ms = 5.0, separation_ms = 20.0, echo_ms = 25.0;
  std::size_t line = 0; // of the file it came from
};

// b = (gamma G delta)^2 (Delta - delta / 3); each pair of delta and Delta is one shape.
Protocol pulsed(const std::vector<Pulses> &rows);

// Gradients by samples: row r, sample i holds gamma G (rad/um/ms) during i * step .. (i + 1) * step. The
// shapes are an orthogonal basis of all components, so that rotated copies of one encoding share three.
struct Waveforms {
  double step_ms = 0.0;
  std::vector<std::vector<glm::dvec3>> row;
};
Protocol sampled(const Waveforms &waveforms);

// Adds interval borders at these times (ms) and asks for the displacement there; the timeline grows to the
// last.
void record_at(Timeline &timeline, const std::vector<double> &times);

// Shell of each measurement, numbered by first appearance: same b, times, and eigenvalues of the b-tensor.
std::vector<std::uint32_t> shells(const Protocol &protocol);

// `count` directions of a half sphere that repel each other and their opposites (Jones et al. 1999), always
// the same ones.
std::vector<glm::dvec3> spread_directions(std::size_t count);

} // namespace conceg::simulate
