// SPDX-License-Identifier: BSD-3-Clause
// How many cells of each type stand in each layer. Lengths in um, densities in um^-3.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace conceg::place {

constexpr double kNotGiven = NAN;

// Cell density along z, linear between the knots and constant beyond the first and the last. No knots = even.
struct Profile {
  std::vector<double> z, density; // z ascending

  double at(double height) const;
  // Exact integral over [lo, hi], um^-2.
  double integral(double lo, double hi) const;
};

struct Layer {
  std::string name;
  double z_lo, z_hi;
  double density = kNotGiven;
};

// Either a fraction of the cells of its layers, or a density of its own.
struct TypeShare {
  std::string name;
  double fraction = kNotGiven;
  double density = kNotGiven;
  int layer = -1;       // -1 = every layer (fraction), or the whole box (own density)
  bool passing = false; // passing axons: no cells are counted
};

struct Box {
  double area, z_lo, z_hi; // cross-section in um2, and the range of z
};

// Cells of one type in one range of z, spread along z like the profile when it has knots.
struct Demand {
  std::size_t type;
  int layer; // -1 = the whole box
  double z_lo, z_hi;
  bool by_profile;
  double expected;     // density x volume
  std::uint64_t count; // after rounding
};

// Density x volume for every (layer, type), rounded to whole cells by the largest remainder, so that the
// counts add up to the rounded total. `density` is that of the whole box; kNotGiven where the layers or the
// profile give it. No demands where all types are passing axons.
std::vector<Demand> compose(const Box &box, const std::vector<Layer> &layers,
                            const std::vector<TypeShare> &types, double density, const Profile &profile);

// Sets `count` of each row from `expected`: the whole part, and one more for the largest remainders, so that
// the counts add up to the rounded total, which must be a cell at least.
void round_by_largest_remainder(std::vector<Demand> &demands);

} // namespace conceg::place
