// SPDX-License-Identifier: BSD-3-Clause
// The sphere of a model: by the Gaussian phase distribution, or exact.
#pragma once

#include "parallel.hpp"
#include "sandi.hpp"

namespace conceg::fit {

// Ready for b up to `most_b` and for all values within the model's bounds.
Sphere make_sphere(const Model &model, const Timing &timing, double most_b, Workers &workers,
                   const Progress &progress);

} // namespace conceg::fit
