// SPDX-License-Identifier: BSD-3-Clause
// The comparison as tables and as lines for people.
#pragma once

#include "compare.hpp"
#include "statistics_table.hpp"

namespace conceg::analyse {

Table comparison_table(const CompareInput &input, const std::vector<ComparisonRow> &rows);
Table comparison_bars_table(const std::vector<BarsRow> &bars);

// By type: grown, drawn, donors and the differences, with Table 1 of the paper where it has the entry; then
// the bars. Ends with what the columns mean.
std::vector<std::string> comparison_lines(const CompareInput &input, const std::vector<ComparisonRow> &rows,
                                          const std::vector<BarsRow> &bars);

} // namespace conceg::analyse
