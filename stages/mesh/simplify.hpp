// SPDX-License-Identifier: BSD-3-Clause
// Quadric edge collapse of one closed surface with guards: the result stays closed and manifold, no face
// turns over, every vertex of the base stays within its tolerance of the result, and every vertex of the
// result within that of the base.
#pragma once

#include "surface.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace conceg::mesh {

// `tolerance` (um) of each vertex; those with 0 stay where they are with all their faces. `keep_going` is
// asked now and then; false stops with an unfinished (still valid) surface.
Surface simplify(const Surface &base, const std::vector<float> &tolerance,
                 const std::function<bool()> &keep_going);

} // namespace conceg::mesh
