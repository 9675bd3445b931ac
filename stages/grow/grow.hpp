// SPDX-License-Identifier: BSD-3-Clause
// Synthetic growth: rounds in which each working cell offers one step of one of its projections (more when
// few cells work); steps that would see each other are put off to a later round, so a round equals its steps
// one after another.
#pragma once

#include "parallel.hpp"
#include "state.hpp"

namespace conceg::grow {

struct Summary {
  std::uint64_t rounds = 0, steps = 0, deferred = 0, collapses = 0;
  std::uint64_t done = 0, cut_short = 0, lost = 0, handed = 0;
  std::vector<std::uint64_t> steps_by_worker;
  double angle_error = 0.0; // mean of first edges against the drawn angle, rad
};

// Makes the space and grows every bar of the input. Throws Error (cancelled) when progress says stop.
Summary grow(State &state, unsigned threads, const Progress &progress);

} // namespace conceg::grow
