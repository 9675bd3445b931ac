// SPDX-License-Identifier: BSD-3-Clause
// Part of the check: one surface by itself.
#pragma once

#include "check.hpp"

namespace conceg::mesh {

// Adds what is wrong with one surface to `out`; `plain` tells its vertices with a plain star: seen along some
// direction the faces around the vertex lie side by side, so that no two of them meet but in what they share
// (README, the check). False when an index is out of range or a face is degenerate, so that the pair test
// cannot take the surface.
bool check_topology(const SurfaceView &surface, std::uint32_t number, std::vector<Defect> &out, Bits &plain);

} // namespace conceg::mesh
