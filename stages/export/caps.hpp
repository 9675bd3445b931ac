// SPDX-License-Identifier: BSD-3-Clause
// Flat lids on the holes that a plane has left in a closed surface.
#pragma once

#include "tile.hpp"

namespace conceg::exporting {

// A surface of which each face remembers the face that it came from.
struct CutSurface : Surface {
  std::vector<std::uint32_t> source_face;
};

// Closes the holes that lie in the plane x[axis] = value; the solid is on the side of `inward` (+1 or -1).
// The corners are those of the rims: no point is added, so lids are as equal as rims are. Decisions are
// exact, on coordinates rounded to 2^-24 um. Lids take the source of a face at their rim. E_UNSUPPORTED where
// rims touch.
void add_caps(CutSurface &surface, int axis, double value, int inward);

} // namespace conceg::exporting
