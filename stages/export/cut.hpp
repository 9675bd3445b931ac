// SPDX-License-Identifier: BSD-3-Clause
// Surfaces as simulators with a box of their own take them.
#pragma once

#include "caps.hpp"

namespace conceg::exporting {

// The surface within the box, open where a periodic side cuts it: all its images, cut at the periodic sides.
// New vertices lie exactly on a side, one for each edge that crosses it. Where vertices are multiples of
// 2^-24 um, as meshes have them, the rims on opposite sides are images of each other bit for bit.
// With `open_sides` they are cut at the sides of open axes too.
CutSurface cut_at_box(const conceg_box &box, const Surface &surface, bool open_sides = false);

// The same, each piece closed by lids that lie in the sides. The surface must be closed.
CutSurface capped_at_box(const conceg_box &box, const Surface &surface);

// The surface moved by -origin and multiplied by scale.
Surface placed(Surface surface, const glm::dvec3 &origin, double scale);

// Adds a surface to another; vertices of different surfaces stay apart.
void append(Surface &to, const Surface &surface);

} // namespace conceg::exporting
