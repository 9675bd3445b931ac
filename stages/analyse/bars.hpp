// SPDX-License-Identifier: BSD-3-Clause
// Asked versus achieved bars.
#pragma once

#include "tissue.hpp"

#include <array>

namespace conceg::analyse {

struct BarCount {
  std::array<std::uint64_t, 5> state = {0, 0, 0, 0, 0}; // waiting, done, short, lost, handed over
  double asked = 0, achieved = 0;                       // um of path
  double missing = 0; // um, summed over the bars that are shorter than asked
  std::uint64_t bars() const { return state[0] + state[1] + state[2] + state[3] + state[4]; }
  void add(const BarCount &other);
};

// Per cell. Needs checked bars.
std::vector<BarCount> count_bars(const Bars &bars);

} // namespace conceg::analyse
