// SPDX-License-Identifier: BSD-3-Clause
// One step of one projection, proposed against the frozen state.
#pragma once

#include "edit.hpp"
#include "navigate.hpp"

namespace conceg::grow {

// Radius with which the edge from `from` to a candidate can be committed, at most the wanted one; negative =
// not at all.
double edge_radius(const State &state, std::uint32_t bar, const Vertex &from, const Candidate &candidate);

// The next edit of a projection: its first edge, a step (with settling, perhaps the end of the bar), or a
// collapse.
void propose(const State &state, std::uint32_t bar, Edit &edit);

} // namespace conceg::grow
