// SPDX-License-Identifier: BSD-3-Clause
// A stationary Gaussian process along the path of a bar (Ornstein-Uhlenbeck): mean 0, variance 1,
// autocorrelation exp(-lag / correlation length). Drawn once on a fixed grid of path length, so that what was
// taken back and grows anew meets the same values.
#pragma once

#include "conceg/rng.h"

#include <vector>

namespace conceg::grow {

class Walk {
public:
  // From `first` to `last` (path length, um), with the given value at `first`.
  void draw(double first, double last, double correlation_length_um, double first_value, conceg_rng stream);
  bool drawn() const { return !value_.empty(); }
  // Between knots on the straight line of its neighbours; beyond the ends the value there.
  double at(double path) const;
  // Largest value between two path lengths.
  double largest(double from, double to) const;

private:
  double first_ = 0.0, spacing_ = 1.0;
  std::vector<float> value_;
};

// A value of the stationary process: standard normal.
double first_value(conceg_rng &stream);

} // namespace conceg::grow
