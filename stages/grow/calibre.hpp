// SPDX-License-Identifier: BSD-3-Clause
// Calibre: the radius of a bar along its path, taper law x exp(g - sd^2 / 2), g a Gaussian process. Lengths
// in um.
#pragma once

#include "state.hpp"

namespace conceg::grow {

// Draws g for a bar whose path begins at its start_path: anew for a root, from the host's value there for a
// fork.
void draw_calibre(State &state, std::uint32_t bar);
bool calibre_varies(const State &state, std::uint32_t bar);

// The taper law of a bar at a path length, at most what its parent's law leaves it: r_0 of the cost.
double law_radius(const State &state, std::uint32_t bar, double path);
// Target radius of a bar at a path length, and the radius that growth commits at most.
double target_radius(const State &state, std::uint32_t bar, double path);
double wanted_radius(const State &state, std::uint32_t bar, double path);
// For a whole segment: the larger of its ends.
double wanted_radius(const State &state, std::uint32_t bar, double path_from, double path_to);
// No segment between these path lengths, nor one that a step adds there, wants more.
double widest_wanted(const State &state, std::uint32_t bar, double path_from, double path_to);

} // namespace conceg::grow
