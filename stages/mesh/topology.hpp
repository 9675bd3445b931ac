// SPDX-License-Identifier: BSD-3-Clause
// Part of the check: is one surface by itself closed, manifold and outward?
#pragma once

#include "check.hpp"

namespace conceg::mesh {

// Adds what is wrong to `out`. False when an index is out of range or a face is degenerate, so that the pair
// test cannot take the surface.
bool check_topology(const Surface &surface, std::uint32_t number, std::vector<Defect> &out);

} // namespace conceg::mesh
