// SPDX-License-Identifier: BSD-3-Clause
// One row per entry: what its dendrites measure, cell by cell, beside the rows "Real" of the paper's Table 1.
#pragma once

#include "mean_sd.hpp"
#include "metrics.hpp"
#include "statistics_table.hpp"

#include <string>
#include <vector>

namespace conceg::characterise {

// One cell's figures: means over its branches (order 1 at the root), forks of two and tips. Angle in degree.
struct CellRow {
  double order = 0.0, length_um = 0.0, angle_degree = 0.0, remote_angle_degree = 0.0, tips = 0.0, stems = 0.0,
         cable_um = 0.0, soma_radius_um = 0.0, radius_um = 0.0;
  metrics::Spread straightness, straightness_1um, tip_straightness; // over branches and tips, to be pooled
};
CellRow row_of(const metrics::Group &dendrites, double soma_radius_um, double radius_um);

class Summary {
public:
  void open(const std::string &entry) { entries_.push_back({entry, {}, 0}); }
  void add(const CellRow &row) { entries_.back().cells.push_back(row); }
  void pool() { entries_.back().pooled++; } // of the cells, one from another group
  Table table() const;
  // For people: aligned lines, an entry's own figures, below them the paper's, and the difference in the
  // paper's sd.
  std::vector<std::string> lines() const;

private:
  struct Entry {
    std::string name;
    std::vector<CellRow> cells;
    std::size_t pooled;
  };
  struct Figures;
  static Figures figures_of(const Entry &entry);
  std::vector<Entry> entries_;
};

} // namespace conceg::characterise
