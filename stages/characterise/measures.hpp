// SPDX-License-Identifier: BSD-3-Clause
// The metrics of all cells as tables: a row per section, per group of a cell's trees, and per sphere of
// Sholl.
#pragma once

#include "metrics.hpp"
#include "morphology.hpp"
#include "preprocess.hpp"
#include "statistics_table.hpp"

#include <string>

namespace conceg::characterise {

constexpr double sholl_step_um = 10.0;

// A reconstruction as read, and as cleaned.
metrics::Samples whole_cell(const Samples &samples, const glm::dvec3 &soma, double soma_radius);
metrics::Samples whole_cell(const Cell &cell);

class Measures {
public:
  void add(const std::string &entry, const std::string &donor, const metrics::Metrics &cell);
  const Table &sections() const { return sections_; }
  const Table &cells() const { return cells_; }
  const Table &sholl() const { return sholl_; }

private:
  Table sections_{"section_metrics"}, cells_{"cell_metrics"}, sholl_{"sholl"};
};

} // namespace conceg::characterise
