// SPDX-License-Identifier: BSD-3-Clause
// The structural comparison as tables, as lines for people, and as a figure.
#pragma once

#include "statistics_table.hpp"
#include "structure_input.hpp"

namespace conceg::analyse {

// A row per entry, level and trait: means and spreads of both sides, beside Table 1 of the paper.
Table structure_means_table(const std::vector<StructureResult> &results);
// A row per entry, level, trait and statistic, with its floor and verdict. Entries without real cells are
// held against the row that the paper publishes.
Table structure_table(const std::vector<StructureResult> &results);
// Values below which a share of both sides lies, from 0 to 1 by 0.05.
Table structure_quantile_table(const std::vector<StructureResult> &results);

// By entry: both sides, the paper's rows, statistics and verdicts, the ids of the donors. Ends with what the
// lines mean.
std::vector<std::string> structure_lines(const StructureInput &input,
                                         const std::vector<StructureResult> &results);

// structure.svg in the folder: the distributions of both sides by entry and trait. Nothing without a folder,
// and in a build without Cairo.
void draw_structure(const std::string &folder, const std::vector<StructureResult> &results);

} // namespace conceg::analyse
