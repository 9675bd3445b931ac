// SPDX-License-Identifier: BSD-3-Clause
// Target fraction: all radii grow by one length, at most a quarter of each, until the cells fill what is
// asked.
#pragma once

#include "fraction.hpp"

#include <string>

namespace conceg::relax {

constexpr double largest_inflation = 0.25; // of the local radius

// Radii of one class against their targets, over its points; means weighted by length, the coefficients of
// variation by volume.
struct ClassRadii {
  double mean = 0, target_mean = 0, cv = 0, target_cv = 0;
  double mean_ratio() const { return target_mean > 0 ? mean / target_mean : 1; }
  double cv_ratio() const { return target_cv > 0 ? cv / target_cv : 1; }
};

// `class_of` gives the class of each cell, below `classes`.
std::vector<ClassRadii> class_radii(const Bodies &bodies, const std::vector<double> &radius,
                                    const std::vector<double> &target,
                                    const std::vector<std::uint32_t> &class_of, std::size_t classes);

// r + min(c, r / 4) for points; c below 0 takes as much away, down to their floors. Somas stay.
std::vector<double> inflated(const Bodies &bodies, const std::vector<double> &radius, double c);

// How far a class may stray from its target: its mean radius upwards, its CV either way.
struct Tolerance {
  double mean = 0.15, cv = 0.10;
};

struct Inflation {
  enum class Stop {
    none,
    quarter,
    mean,
    cv
  };                   // reached; a quarter of the radius (or a floor) everywhere; a class's tolerance
  double c = 0;        // um
  double fraction = 0; // reached, with contact planes
  Stop stop = Stop::none;
  std::size_t of_class = 0; // whose mean or CV stopped it
};

// The smallest c with which the fraction after contact planes is `asked`, as far as each class keeps its mean
// radius and its CV within the tolerance (a CV that was beyond it before may not get farther). Bisection.
Inflation inflate_to(const Bodies &bodies, const std::vector<double> &radius,
                     const std::vector<double> &target, const std::vector<std::uint32_t> &class_of,
                     std::size_t classes, const glm::dvec3 &side, const Sample &sample, double gap,
                     double asked, const Tolerance &tolerance, Workers &workers);

// The c below 0 nearest to 0 with which the fraction after contact planes is `asked` or less, or the one that
// takes most where none does. Bisection.
Inflation deflate_to(const Bodies &bodies, const std::vector<double> &radius, const glm::dvec3 &side,
                     const Sample &sample, double gap, double asked, Workers &workers);

} // namespace conceg::relax
