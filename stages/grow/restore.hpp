// SPDX-License-Identifier: BSD-3-Clause
// Second growth: projections as an earlier growth and what moved them since left them. Bars that are done
// stay as they are; the others go on from their tips.
#pragma once

#include "state.hpp"

namespace conceg::grow {

// Restores the projections of state.input.earlier and puts them into the space, committed as growth commits
// them. E_RANGE where a bar starts on a point from which none can.
void restore(State &state);

} // namespace conceg::grow
