// SPDX-License-Identifier: BSD-3-Clause
// Synthetic growth: rounds in which each working cell offers one step of one of its projections (more when
// few cells work); steps that would see each other are put off to a later round, so a round equals its steps
// one after another.
#pragma once

#include "parallel.hpp"
#include "phases.hpp"
#include "state.hpp"

#include <functional>

namespace conceg::grow {

struct Summary {
  std::uint64_t rounds = 0, steps = 0, deferred = 0, collapses = 0;
  std::uint64_t done = 0, cut_short = 0, lost = 0, handed = 0;
  std::vector<std::uint64_t> steps_by_worker;
  double busy_s = 0.0;      // of all workers in parallel parts
  double angle_error = 0.0; // mean of first edges against the drawn angle, rad
};

// How far growth is.
struct Standing {
  double cable_um = 0.0, asked_um = 0.0;
  std::size_t cells_done = 0, cells = 0;
  double occupied_um3 = 0.0; // by somas and committed pieces, joints counted twice
};

// Who looks on; each may be empty. `before` sees the frozen state of a round and the bars whose steps it
// accepted, by priority; `after` the state with these steps committed, before anything follows from them.
struct Watch {
  std::function<void(const Standing &)> tenth; // at each tenth of the cable
  std::function<void(const State &, const std::vector<std::uint32_t> &)> before;
  std::function<void(const State &)> after;
};

// Makes the space and grows every bar of the input. Throws Error (cancelled) when progress says stop.
Summary grow(State &state, unsigned threads, const Progress &progress, Phases &phases,
             const Watch &watch = {});

} // namespace conceg::grow
