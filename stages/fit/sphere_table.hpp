// SPDX-License-Identifier: BSD-3-Clause
// The exact signal of a sphere for a range of b, radius and diffusivity, from a table that is made once.
#pragma once

#include "parallel.hpp"
#include "signal.hpp"

#include <vector>

namespace conceg::fit {

struct SphereRange {
  double b = 15.0;                                      // largest
  double radius_low = 1.0, radius_high = 15.0;          // um
  double diffusivity_low = 3.0, diffusivity_high = 3.0; // um^2/ms
};

// Lengths in units of sqrt D leave two variables, S(b, R, D) = E(b D, R / sqrt D): Chebyshev polynomials in
// both.
class SphereTable {
public:
  // Takes more nodes until the last coefficients are below 1e-8; E_UNSUPPORTED when 160 a side do not do.
  SphereTable(const Timing &timing, const SphereRange &range, Workers &workers, const Progress &progress);
  SphereSignal operator()(double b, double radius_um, double diffusivity) const;

private:
  struct Side {
    double low, high;
    std::size_t nodes;
    double node(std::size_t i) const;
  };
  void fill(const Timing &timing, Workers &workers, const Progress &progress);
  double tail(bool of_radius) const;
  Side strength_, radius_;
  std::vector<double> coefficient_; // strength_.nodes x radius_.nodes
};

} // namespace conceg::fit
