// SPDX-License-Identifier: BSD-3-Clause
// One walker between membranes: steps of fixed length in random directions near them, Gaussian jumps far from
// them; elastic reflection, or passage where a membrane lets it through.
#pragma once

#include "draws.hpp"
#include "walls.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

namespace conceg::simulate {

// What the walk of every walker follows: intervals of constant gradient.
struct Timeline {
  std::vector<double> end;   // ms, ascending, > 0; the first interval begins at 0
  std::vector<double> shape; // [shapes][intervals]
  std::size_t shapes = 0;
  std::vector<std::uint8_t> record; // per interval: the displacement at its end is asked for
  std::size_t intervals() const { return end.size(); }
  std::size_t records() const;
};

struct Medium {
  double diffusivity = 2.0;     // um^2/ms
  double relaxation_rate = 0.0; // 1/ms, 1/T2
};

struct Physics {
  Medium intra, extra;
  double step_ms = 1e-3;
  std::vector<double> permeability; // um/ms per face of Membranes; empty = none lets anything through
  bool absorb = false;              // a walker that passes a membrane is gone
  bool jumps = true;                // Gaussian jumps far from membranes
  bool skip = true;                 // steps that cannot reach a membrane are not held against any
};

inline double step_length(const Medium &medium, double step_ms) {
  return std::sqrt(6.0 * medium.diffusivity * step_ms);
}

struct Tally {
  std::uint64_t steps = 0; // of step_ms of simulated time
  std::uint64_t moves = 0; // steps and jumps that were made
  std::uint64_t jumps = 0; // of them jumps
  std::uint64_t casts = 0; // moves held against membranes
  std::uint64_t reflections = 0;
  std::uint64_t passages = 0;
  std::uint64_t retractions = 0; // moves taken back after too many reflections
  void add(const Tally &other);
};

struct Walk {
  glm::dvec3 place;    // local (Walls), at the end
  bool inside = false; // a cell, by the membranes passed
  bool absorbed = false;
  double absorbed_ms = 0.0;
  double weight = 1.0;                  // left by relaxation
  std::vector<glm::dvec3> vector;       // per shape: integral of shape(t) (x(t) - x(0)) dt, um ms
  std::vector<glm::dvec3> displacement; // per record, um
};

struct Start {
  glm::dvec3 place;     // local (Walls)
  bool inside;          // a cell
  std::uint64_t number; // of the walker: its draws depend on this and the seed alone
};

// Each walker's way through the whole timeline. The longest step must not exceed the walls' reach.
std::vector<Walk> walk(const Walls &walls, const Timeline &timeline, const Physics &physics,
                       const Start *start, std::size_t count, std::uint64_t seed, Tally &tally);

} // namespace conceg::simulate
