// SPDX-License-Identifier: BSD-3-Clause
#include "compare_report.hpp"

#include "published.hpp"
#include "report_lines.hpp"

#include <algorithm>

namespace conceg::analyse {
namespace {

constexpr std::size_t bar_field_width = 11;

// The columns of the printed table.
struct Shown {
  Measure measure;
  const char *title;
  int digits, error_digits; // of a mean; of a difference and its error
  double scale;
};
constexpr Shown shown[] = {
    {Measure::order, "order", 2, 2, 1.0},
    {Measure::branch_length, "branch um", 1, 1, 1.0},
    {Measure::straightness, "straightness", 3, 3, 1.0},
    {Measure::local_angle, "angle degree", 0, 1, 1.0},
    {Measure::cable, "cable mm", 2, 3, 1e-3},
    {Measure::tips, "tips", 1, 1, 1.0},
};

// The rows of one type and part, found by measure.
using Block = std::vector<const ComparisonRow *>;
const ComparisonRow *find(const Block &block, Measure measure) {
  for (const ComparisonRow *row : block)
    if (row->measure == measure) return row;
  return nullptr;
}

// One field a column; "-" where the block has no such row.
template <class Field> std::vector<std::string> fields_of(const Block &block, Field field) {
  std::vector<std::string> out;
  for (const Shown &column : shown) {
    const ComparisonRow *row = find(block, column.measure);
    out.push_back(row ? field(*row, column) : std::string("-"));
  }
  return out;
}

// One value alone has neither an sd nor an error.
std::string mean_field(const MeanSd &m, const Shown &column) {
  if (!m.count) return "-";
  if (m.count < 2) return formatted("%.*f", column.digits, column.scale * m.mean);
  return formatted("%.*f +- %.*f", column.digits, column.scale * m.mean, column.digits, column.scale * m.sd);
}
std::string difference_field(const Difference &d, const Shown &column) {
  if (!d.count) return "-";
  if (d.count < 2) return formatted("%+.*f", column.error_digits, column.scale * d.mean);
  return formatted("%+.*f (%.*f)", column.error_digits, column.scale * d.mean, column.error_digits,
                   column.scale * d.standard_error);
}

std::vector<std::string> means(const Block &block, MeanSd ComparisonRow::*side) {
  return fields_of(
      block, [&](const ComparisonRow &row, const Shown &column) { return mean_field(row.*side, column); });
}
std::vector<std::string> differences(const Block &block, Difference ComparisonRow::*side) {
  return fields_of(block, [&](const ComparisonRow &row, const Shown &column) {
    return difference_field(row.*side, column);
  });
}
std::vector<std::string> effects(const Block &block, bool held_back) {
  return fields_of(block, [&](const ComparisonRow &row, const Shown &) {
    const Difference &d = row.from_drawn.count && !held_back ? row.from_drawn : row.from_donors;
    return d.count ? formatted("%+.2f", d.in_sd) : std::string("-");
  });
}
std::vector<std::string> verdicts(const Block &block) {
  return fields_of(block, [&](const ComparisonRow &row, const Shown &) { return row.within; });
}

std::vector<std::string> published_fields(const PublishedRow &row) {
  return {formatted("%.2f +- %.2f", row.order, row.order_sd),
          formatted("%.1f +- %.1f", row.length_um, row.length_sd_um),
          formatted("%.2f +- %.2f", row.straightness, row.straightness_sd),
          formatted("%.0f +- %.0f", row.angle_degree, row.angle_sd_degree),
          "-",
          "-"};
}

std::string count_of(const Block &block, MeanSd ComparisonRow::*side) {
  const ComparisonRow *row = find(block, Measure::order);
  return std::to_string(row ? (row->*side).count : 0);
}

void add_block(const CompareInput &in, const Block &block, std::vector<std::string> &out) {
  const ComparisonRow &first = *block.front();
  const auto entry = std::find_if(in.entries.begin(), in.entries.end(),
                                  [&](const Entry &e) { return e.name == first.entry; });
  const bool axon = first.part == Part::axon, held_back = entry->has_held_back();
  out.push_back(line_of(in.type_name[first.type] + (axon ? ", axons" : ""),
                        count_of(block, &ComparisonRow::grown), means(block, &ComparisonRow::grown)));
  out.push_back(
      line_of("  drawn", count_of(block, &ComparisonRow::drawn), means(block, &ComparisonRow::drawn)));
  out.push_back(line_of(held_back ? "  donors held back" : "  donors of the entry",
                        count_of(block, &ComparisonRow::donors), means(block, &ComparisonRow::donors)));
  out.push_back(line_of("  from drawn", "", differences(block, &ComparisonRow::from_drawn)));
  out.push_back(line_of(held_back ? "  from held back" : "  from entry", "",
                        differences(block, &ComparisonRow::from_donors)));
  out.push_back(line_of("  in sd", "", effects(block, held_back)));
  out.push_back(line_of("  within the tolerance", "", verdicts(block)));
  const Published *paper = axon ? nullptr : find_published(first.entry);
  if (!paper) return;
  out.push_back(
      line_of("  paper, ConCeG", std::to_string(paper->grown.cells), published_fields(paper->grown)));
  out.push_back(line_of("  paper, real", std::to_string(paper->real.cells), published_fields(paper->real)));
}

void add_bar_lines(const std::vector<BarsRow> &bars, std::vector<std::string> &out) {
  if (bars.empty()) return;
  out.push_back(line_of("bars", "asked",
                        {"done %", "short %", "lost %", "handed %", "waiting %", "reached %", "length",
                         "start um", "grown", "95 % done"},
                        bar_field_width));
  for (const BarsRow &row : bars) {
    const auto percent = [&](std::uint64_t count) { return formatted("%.1f", 100.0 * row.share(count)); };
    out.push_back(line_of(row.type, std::to_string(row.bars.bars()),
                          {percent(row.bars.state[1]), percent(row.bars.state[2]), percent(row.bars.state[3]),
                           percent(row.bars.state[4]), percent(row.bars.state[0]), percent(row.reached),
                           formatted("%.3f", row.length_ratio()),
                           row.forks ? formatted("%+.2f", row.mean_start_bias_um()) : std::string("-"),
                           std::to_string(row.cells_grown) + "/" + std::to_string(row.cells),
                           row.within() ? "yes" : "no"},
                          bar_field_width));
  }
}

void put_mean(Table &table, const std::string &name, const MeanSd &m) {
  table.put((name + "_count").c_str(), m.count);
  table.put((name + "_mean").c_str(), m.mean, ""), table.put((name + "_sd").c_str(), m.sd, "");
}
void put_difference(Table &table, const std::string &name, const Difference &d) {
  table.put((name + "_count").c_str(), d.count);
  table.put(name.c_str(), d.mean, ""), table.put((name + "_standard_error").c_str(), d.standard_error, "");
  table.put((name + "_in_sd").c_str(), d.in_sd, "1");
}

} // namespace

Table comparison_table(const CompareInput &in, const std::vector<ComparisonRow> &rows) {
  Table table("comparison");
  for (const ComparisonRow &row : rows) {
    table.put("type", in.type_name[row.type]), table.put("entry", row.entry);
    table.put("part", std::string(row.part == Part::axon ? "axon" : "dendrites"));
    table.put("measure", std::string(name_of(row.measure)));
    table.put("unit", std::string(unit_of(row.measure)));
    put_mean(table, "grown", row.grown), put_mean(table, "drawn", row.drawn);
    put_mean(table, "donors", row.donors);
    put_difference(table, "from_drawn", row.from_drawn);
    put_difference(table, "from_donors", row.from_donors);
    table.put("against", row.against), table.put("within", row.within);
  }
  return table;
}

Table comparison_bars_table(const std::vector<BarsRow> &bars) {
  Table table("comparison_bars");
  for (const BarsRow &row : bars) {
    table.put("type", row.type);
    table.put("cells", row.cells), table.put("cells_grown", row.cells_grown);
    table.put("asked", row.bars.bars());
    const char *const states[] = {"waiting", "done", "short", "lost", "handed"};
    for (std::size_t s = 0; s < row.bars.state.size(); s++)
      table.put(states[s], row.share(row.bars.state[s]), "1");
    table.put("reached", row.share(row.reached), "1");
    table.put("length_ratio", row.length_ratio(), "1");
    table.put("start_bias", row.mean_start_bias_um(), "um");
    table.put("within", std::string(row.within() ? "yes" : "no"));
  }
  return table;
}

std::vector<std::string> comparison_lines(const CompareInput &in, const std::vector<ComparisonRow> &rows,
                                          const std::vector<BarsRow> &bars) {
  std::vector<std::string> titles, out;
  for (const Shown &column : shown)
    titles.emplace_back(column.title);
  out.push_back(line_of("dendrites or processes", "cells", titles));
  for (std::size_t i = 0; i < rows.size();) {
    Block block;
    for (const std::size_t one = i;
         i < rows.size() && rows[i].type == rows[one].type && rows[i].part == rows[one].part; i++)
      block.push_back(&rows[i]);
    add_block(in, block, out);
  }
  add_bar_lines(bars, out);
  out.emplace_back(
      "Mean +- sd of the cells' means (straightness: of all branches, resampled at 1 um). Drawn: "
      "the bars that each cell was asked for; differences from it cell by cell, (standard error).");
  out.push_back(
      formatted("In sd of the entry's donors. Within: order and branch |in sd| <= %g; straightness "
                "|difference| + standard error <= %g; unsure: missed by less than a standard error.",
                tolerance_in_sd, straightness_tolerance));
  for (const Entry &entry : in.entries)
    if (entry.has_held_back()) {
      out.emplace_back("Donors were held back: order and branch are judged against those alone, straightness "
                       "against all (the dictionary has no other).");
      break;
    }
  return out;
}

} // namespace conceg::analyse
