// SPDX-License-Identifier: BSD-3-Clause
// Roots: where each tree leaves its soma, and where a cell without one starts.
#pragma once

#include "edit.hpp"

namespace conceg::grow {

// First edge of a root bar: from the soma's surface, towards the nearest free node outside the soma along the
// direction of the bar's attractor, apart from the cell's other roots. Without a soma: from the free node
// nearest to the cell's place (ties: lower node), along the cheapest edge that has room. False when there is
// none.
bool propose_root(const State &state, std::uint32_t bar, Edit &edit);

} // namespace conceg::grow
