// SPDX-License-Identifier: BSD-3-Clause
// Passing axons: cable without a soma that crosses the box, drawn as straight lines until the density of
// cable is reached. Lengths in um.
#pragma once

#include "composition.hpp"
#include "donors.hpp"
#include "laws.hpp"
#include "somas.hpp"

#include "conceg/geom.h"
#include "parallel.hpp"

#include <cstdint>
#include <vector>

namespace conceg::place {

struct AxonLaw {
  double cable_density = 0.35; // um of cable per um3 of box
  double length = kNotGiven;   // of each axon
  GammaLaw radius = {0.35, 0.1, 0.25};
  WatsonLaw direction = {{0, 0, 1}, 0.0};
};

struct Axon {
  std::uint64_t id; // names its random streams
  glm::dvec3 start; // in the box
  glm::dvec3 direction;
  double length, radius;
};

constexpr double kMostCable = 1.0; // um per um3, of all types together: more finds no room beside cells

// Length of the axons where the recipe gives none: the shortest periodic side, so that an axon crosses the
// box once; the diagonal of a box without one, where the sides cut it.
double default_length(const conceg_box &box);

// The axons of one type, ids first_id, first_id + id_step, ... Each is a piece of a stationary process of
// straight lines, and begins outside all `somas`: periodic sides let it through, open ones cut it. The last
// one is shortened so that the lengths add up to density x volume. `name` stands in errors.
std::vector<Axon> draw_axons(const conceg_box &box, const AxonLaw &law, const Somas &somas,
                             std::uint64_t first_id, std::uint64_t id_step, std::uint64_t seed,
                             const char *name, const Progress &progress);

// Appends the one bar of an axon.
void append_axon(const Axon &axon, double min_radius_um, Bars &bars);

} // namespace conceg::place
