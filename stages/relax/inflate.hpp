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

// r + min(c, r / 4) for points; somas stay.
std::vector<double> inflated(const Bodies &bodies, const std::vector<double> &radius, double c);

struct Inflation {
  double c = 0;        // um
  double fraction = 0; // reached, with contact planes
  std::size_t stop =
      0; // 0: reached; 1: a quarter of the radius everywhere; 2 + k: the mean radius of class k
};

// The smallest c with which the fraction after contact planes is `asked`, as far as each class keeps its mean
// radius within `mean_tolerance` of its target. Bisection: both grow with c.
Inflation inflate_to(const Bodies &bodies, const std::vector<double> &radius,
                     const std::vector<double> &target, const std::vector<std::uint32_t> &class_of,
                     std::size_t classes, const glm::dvec3 &side, const Sample &sample, double gap,
                     double asked, double mean_tolerance, Workers &workers);

} // namespace conceg::relax
