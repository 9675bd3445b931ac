// SPDX-License-Identifier: BSD-3-Clause
// D(t) and K(t) of the walkers of each compartment, how D(t) ends, and lambda of the extracellular space.
#pragma once

#include "diffusion_tail.hpp"
#include "displacements.hpp"
#include "parallel.hpp"
#include "statistics_table.hpp"
#include "transport.hpp"

namespace conceg::analyse {

// Of one direction and law.
struct NamedTail {
  int axis = mean_axis;
  double asked = 0.0; // exponent that was held; 0 = fitted
  Tail tail;
};

struct Diffusivity {
  std::string compartment; // all, intra, extra, soma, neurite, or class NAME: where the walkers began
  std::uint64_t walkers = 0;
  std::vector<Spread> spread;   // per time
  std::vector<NamedTail> tails; // mean, x, y, z by fitted exponent, 1/2 and 1
};

// Range of the fits, ms; times outside are left out.
struct TailRange {
  double from = 0.0, to = 0.0;
};

std::vector<Diffusivity> diffusivities(const Displacements &walked, const Cells &cells,
                                       const TailRange &range, Workers &workers);

// lambda = sqrt(D_0 / D*) of the extracellular space, D* the slope of <x^2> / 2: in a periodic box
// <x^2> = 2 D* t + constant, so that D(t) = D* + amplitude / t.
struct WalkedLambda {
  std::string state; // fitted, rejected or void: why
  Mean ratio[3], lambda;
};
WalkedLambda walked_lambda(const std::vector<Diffusivity> &all, const Displacements &walked);

Table diffusivity_table(const std::vector<Diffusivity> &all, const std::vector<double> &time);
Table diffusivity_fit_table(const std::vector<Diffusivity> &all, const TailRange &range);
// `solved` null: without the row of the solver, whose error is what the extrapolation to voxels of 0 changed.
Table lambda_table(const WalkedLambda &walked, const Transport *solved, const Transport *finest);

} // namespace conceg::analyse
