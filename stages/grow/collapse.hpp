// SPDX-License-Identifier: BSD-3-Clause
// Fibre collapse: a trapped projection backtracks g0 and regrows without the nodes that trapped it.
#pragma once

#include "edit.hpp"

namespace conceg::grow {

// Vertices that may never be removed: the start, and everything up to the last fork.
std::uint32_t least_kept(const Projection &projection);

// The k-th collapse in one place removes the last k g0 and bans the trap node and the two before it; after
// the last retry the bar is ended where it stands.
void propose_collapse(const State &state, std::uint32_t bar, Edit &edit);

// Serial bookkeeping of collapses: counts one, or forgets them (and the bans) once the old maximum is passed
// by 1 um.
void note_collapse(Projection &projection, const Edit &edit, double trapped_at);
void note_progress(Projection &projection);

} // namespace conceg::grow
