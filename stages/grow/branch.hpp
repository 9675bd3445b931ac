// SPDX-License-Identifier: BSD-3-Clause
// Branching: when a bar forks off, from whom, and in which direction.
#pragma once

#include "edit.hpp"

namespace conceg::grow {

constexpr double hazard_length_um = 1.0; // h0

// How far before its il a bar forks, for a hazard e^{lambda (pl - il)} / h0 per um that is certain at pl >=
// il, starting `ahead` um before il, from one Exp(1) draw: x* = -ln(e^{-lambda ahead} + lambda h0 E) /
// lambda, at least 0.
double early_distance(double lambda, double ahead, double draw);
// The paper's probability at one step: e^{lambda (pl - il)}, at most 1.
double step_probability(double lambda, double path, double initiation);

// Direction at `angle` from the host's heading, turned towards the attractor; a drawn azimuth where that is
// undecided.
glm::dvec3 daughter_direction(const glm::dvec3 &heading, const glm::dvec3 &to_attractor, double angle,
                              double azimuth);

// First edge of a daughter: from its fork to the viable node nearest to the drawn direction (with smoothing
// the first vertex stands exactly in that direction when there is room).
void propose_start(const State &state, std::uint32_t bar, Edit &edit);

// ---- Serial bookkeeping ----
// A projection took its first edge: the bars whose parent it is wait on it.
void adopt_children(State &state, std::uint32_t bar);
// Bars that are due on a host after it settled the vertices from `first_settled` on; they leave its waiting
// list.
std::vector<std::uint32_t> due_bars(State &state, std::uint32_t host, std::uint32_t first_settled);
// Opens a fork on the host for a due bar. False: the place lies beyond the bar's end.
bool open_fork(State &state, std::uint32_t bar);
// The first edge failed: closes the fork; the bar waits for a later place on its host while attempts are
// left.
bool postpone_fork(State &state, std::uint32_t bar);
// Finds another projection of the tree, growing or done, that may carry an orphaned bar (elder rule: its own
// end >= the bar's end, so that the barcode of what grew is the one that was asked).
std::uint32_t find_host(const State &state, std::uint32_t bar);
void give_to_host(State &state, std::uint32_t bar, std::uint32_t host);
// True while a projection of the tree that has yet to start could still carry the bar.
bool may_find_host(const State &state, std::uint32_t bar);

} // namespace conceg::grow
