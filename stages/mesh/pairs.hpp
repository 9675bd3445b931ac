// SPDX-License-Identifier: BSD-3-Clause
// Part of the check: pairs of faces on a uniform hash of the torus, slab after slab.
#pragma once

#include "check.hpp"

namespace conceg::mesh {

// Tests all pairs of faces of which at least one has `changed`; surfaces that are not
// `usable` are left out, vertices that are `plain` believed. Adds to defects, min_gap and pairs_checked.
void check_pairs(const Views &surfaces, const Changed &changed, const conceg_box &box,
                 const CheckOptions &options, Workers &workers, const Progress &progress,
                 CheckResult &result);

} // namespace conceg::mesh
