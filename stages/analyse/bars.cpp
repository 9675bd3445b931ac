// SPDX-License-Identifier: BSD-3-Clause
#include "bars.hpp"

#include <algorithm>

namespace conceg::analyse {

void BarCount::add(const BarCount &other) {
  for (std::size_t s = 0; s < state.size(); s++)
    state[s] += other.state[s];
  asked += other.asked, achieved += other.achieved, missing += other.missing;
}

std::vector<BarCount> count_bars(const Bars &bars) {
  std::vector<BarCount> cells(bars.cell_offset.size() - 1);
  for (std::size_t cell = 0; cell < cells.size(); cell++)
    for (std::size_t i = bars.cell_offset[cell]; i < bars.cell_offset[cell + 1]; i++) {
      cells[cell].state[bars.state[i]]++;
      const double asked = std::max(0.0, bars.asked_end[i] - bars.asked_start[i]);
      const double achieved = std::max(0.0, bars.achieved_end[i] - bars.achieved_start[i]);
      cells[cell].asked += asked, cells[cell].achieved += achieved,
          cells[cell].missing += std::max(0.0, asked - achieved);
    }
  return cells;
}

} // namespace conceg::analyse
