// SPDX-License-Identifier: BSD-3-Clause
// What a document says about its cells, their donors and the dictionary, for the comparison.
#pragma once

#include "compare.hpp"
#include "parallel.hpp"
#include "tissue.hpp"

#include <functional>

namespace conceg::analyse {

// Metrics of every cell by its skeleton; `take` is called in parallel over cells.
void measure_grown(const Cells &cells, const Skeletons &skeletons, Workers &workers, const Progress &progress,
                   const std::function<void(std::size_t cell, const metrics::Metrics &)> &take);
// Branches of every cell as sums.
std::vector<Shapes> grown_shapes(const Cells &cells, const Skeletons &skeletons, Workers &workers,
                                 const Progress &progress);

// What bars say beside the columns of `Bars`.
struct BarLinks {
  std::vector<std::int64_t> parent;  // row within the cell, -1 = root bar
  std::vector<std::uint8_t> neurite; // SWC code
  std::vector<double> angle;         // rad
};
// Throws E_FORMAT or E_RANGE with dataset[index].
void check(const BarLinks &links, const Bars &bars);
// Branches that every cell was asked to grow.
std::vector<Shapes> drawn_shapes(const Bars &bars, const BarLinks &links);

// The entries of /dictionary; E_MISSING when the document has none.
std::vector<Entry> read_entries(conceg_doc *doc);

} // namespace conceg::analyse
