// SPDX-License-Identifier: BSD-3-Clause
#include "compare.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::analyse {
namespace {

constexpr Measure cell_measures[] = {Measure::order, Measure::branch_length, Measure::local_angle,
                                     Measure::cable, Measure::tips};
constexpr double end_tolerance_um = 1e-3; // grow cuts a bar at its asked end, to 1 nm at most

bool has_value(const Shape &shape, Measure measure) {
  switch (measure) {
  case Measure::order:
  case Measure::branch_length:
    return shape.branches > 0;
  case Measure::local_angle:
    return shape.bifurcations > 0;
  default: // a cell of which nothing grew has a cable of 0
    return true;
  }
}

double value_of(const Shape &shape, Measure measure) {
  switch (measure) {
  case Measure::order:
    return shape.mean_order();
  case Measure::branch_length:
    return shape.mean_length_um();
  case Measure::local_angle:
    return shape.mean_angle_degree();
  case Measure::cable:
    return shape.cable_um;
  default:
    return static_cast<double>(shape.tips);
  }
}

double error_of(const MeanSd &m) {
  return m.count ? m.sd / std::sqrt(static_cast<double>(m.count)) : 0.0;
}

// One type and part: its cells that were asked to grow such trees, and the donors.
struct Sample {
  std::vector<const Shape *> grown, drawn, compared, all;
};

Sample sample_of(const CompareInput &in, std::size_t type, const Entry &entry, Part part) {
  const auto p = static_cast<std::size_t>(part);
  Sample s;
  for (std::size_t cell = 0; cell < in.type.size(); cell++) {
    if (in.type[cell] != type) continue;
    const Shape &grown = in.grown[cell][p], &wanted = in.drawn.empty() ? grown : in.drawn[cell][p];
    if (!wanted.branches) continue;
    s.grown.push_back(&grown);
    if (!in.drawn.empty()) s.drawn.push_back(&wanted);
  }
  const bool held_back = entry.has_held_back();
  for (const Donor &donor : entry.donors) {
    const Shape &shape = donor.shapes[p];
    if (!shape.branches) continue;
    s.all.push_back(&shape);
    if (!held_back || donor.held_back) s.compared.push_back(&shape);
  }
  return s;
}

std::vector<double> values_of(const std::vector<const Shape *> &shapes, Measure measure) {
  std::vector<double> values;
  for (const Shape *shape : shapes)
    if (has_value(*shape, measure)) values.push_back(value_of(*shape, measure));
  return values;
}

// Cell by cell, so that which donors were drawn does not matter.
Difference paired(const Sample &s, Measure measure) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < s.drawn.size(); i++)
    if (has_value(*s.grown[i], measure) && has_value(*s.drawn[i], measure))
      differences.push_back(value_of(*s.grown[i], measure) - value_of(*s.drawn[i], measure));
  const MeanSd m = mean_of(differences);
  return {m.count, m.mean, error_of(m), 0.0};
}

Difference unpaired(const MeanSd &a, const MeanSd &b) {
  if (!a.count || !b.count) return {};
  const double one = error_of(a), other = error_of(b);
  const std::uint64_t count = std::min(a.count, b.count);
  return {count, a.mean - b.mean, count > 1 ? std::sqrt(one * one + other * other) : 0.0, 0.0};
}

// A tolerance that is missed by less than the standard error, or by one value alone, leaves it open.
const char *verdict(bool met, double excess, const Difference &difference, double error) {
  return met ? "yes" : difference.count > 1 && excess > error ? "no" : "unsure";
}

void judge_in_sd(ComparisonRow &row, double sd, bool held_back) {
  for (Difference *difference : {&row.from_drawn, &row.from_donors})
    if (sd > 0.0) difference->in_sd = difference->mean / sd;
  row.against = row.within = "-";
  if (row.measure != Measure::order && row.measure != Measure::branch_length) return;
  // What was drawn is what growth was to reach, unless donors were held back to be compared with.
  const bool drawn = row.from_drawn.count && !held_back;
  const Difference &judged = drawn ? row.from_drawn : row.from_donors;
  if (!judged.count || !(sd > 0.0)) return;
  row.against = drawn ? "drawn" : held_back ? "held back" : "entry";
  const double excess = std::abs(judged.in_sd) - tolerance_in_sd;
  row.within = verdict(excess <= 0.0, excess, judged, judged.standard_error / sd);
}

// Of all branches together, against the value of the entry, which growth was to reach: no error of its own.
void compare_straightness(ComparisonRow &row, const Sample &s, const Entry &entry) {
  Shape sum;
  for (const Shape *shape : s.grown)
    sum.judged += shape->judged, sum.straightness += shape->straightness,
        sum.straightness_squared += shape->straightness_squared;
  row.against = row.within = "-";
  row.donors = {s.all.size(), entry.straightness, entry.straightness_sd};
  row.grown.count = sum.judged;
  if (!sum.judged) return;
  const auto n = static_cast<double>(sum.judged);
  row.grown.mean = sum.straightness / n;
  if (sum.judged < 2) return;
  row.grown.sd =
      std::sqrt(std::max(0.0, sum.straightness_squared - n * row.grown.mean * row.grown.mean) / (n - 1.0));
  Difference &d = row.from_donors;
  d = {sum.judged, row.grown.mean - entry.straightness, error_of(row.grown), 0.0};
  if (entry.straightness_sd > 0.0) d.in_sd = d.mean / entry.straightness_sd;
  row.against = "entry";
  const double excess = std::abs(d.mean) - straightness_tolerance;
  row.within = verdict(excess + d.standard_error <= 0.0, excess, d, d.standard_error);
}

void compare_part(const CompareInput &in, std::size_t type, const Entry &entry, Part part,
                  std::vector<ComparisonRow> &out) {
  const Sample s = sample_of(in, type, entry, part);
  if (s.grown.empty()) return;
  ComparisonRow row;
  row.type = type, row.entry = entry.name, row.part = part;
  for (const Measure measure : cell_measures) {
    row.measure = measure;
    row.grown = mean_of(values_of(s.grown, measure)), row.drawn = mean_of(values_of(s.drawn, measure));
    row.donors = mean_of(values_of(s.compared, measure));
    row.from_drawn = paired(s, measure), row.from_donors = unpaired(row.grown, row.donors);
    judge_in_sd(row, mean_of(values_of(s.all, measure)).sd, entry.has_held_back());
    out.push_back(row);
  }
  if (part == Part::axon) return; // the dictionary's straightness is that of the dendrites
  ComparisonRow straight;
  straight.type = type, straight.entry = entry.name, straight.part = part,
  straight.measure = Measure::straightness;
  compare_straightness(straight, s, entry);
  out.push_back(straight);
}

void add_bars_of(const Bars &bars, const std::vector<std::int64_t> &parent, std::size_t cell, BarsRow &row) {
  for (std::size_t i = bars.cell_offset[cell]; i < bars.cell_offset[cell + 1]; i++) {
    row.reached += bars.state[i] == 1 ||
                   (bars.state[i] == 4 && bars.achieved_end[i] >= bars.asked_end[i] - end_tolerance_um);
    if (parent[i] < 0 || !(bars.achieved_end[i] > bars.achieved_start[i])) continue;
    row.forks++, row.start_bias += bars.achieved_start[i] - bars.asked_start[i];
  }
}

} // namespace

const char *name_of(Measure measure) {
  const char *const names[] = {"order", "branch_length", "local_angle", "cable", "tips", "straightness"};
  return names[static_cast<std::size_t>(measure)];
}
const char *unit_of(Measure measure) {
  const char *const units[] = {"1", "um", "degree", "um", "1", "1"};
  return units[static_cast<std::size_t>(measure)];
}

bool Entry::has_held_back() const {
  return std::any_of(donors.begin(), donors.end(), [](const Donor &donor) { return donor.held_back; });
}

double BarsRow::share(std::uint64_t count) const {
  return bars.bars() ? static_cast<double>(count) / static_cast<double>(bars.bars()) : 0.0;
}

double BarsRow::length_ratio() const {
  return bars.asked > 0.0 ? bars.achieved / bars.asked : 0.0;
}
double BarsRow::mean_start_bias_um() const {
  return forks ? start_bias / static_cast<double>(forks) : 0.0;
}

std::vector<ComparisonRow> compare(const CompareInput &in) {
  std::vector<ComparisonRow> out;
  for (std::size_t type = 0; type < in.type_name.size(); type++)
    for (const Entry &entry : in.entries)
      if (entry.name == in.type_entry[type])
        for (const Part part : {Part::dendrites, Part::axon})
          compare_part(in, type, entry, part, out);
  return out;
}

std::vector<BarsRow> compare_bars(const CompareInput &in, const Bars &bars,
                                  const std::vector<std::int64_t> &parent) {
  const std::vector<BarCount> counts = count_bars(bars);
  std::vector<BarsRow> out(in.type_name.size() + 1);
  for (std::size_t type = 0; type < out.size(); type++)
    out[type].type = type < in.type_name.size() ? in.type_name[type] : "all";
  for (std::size_t cell = 0; cell < in.type.size(); cell++) {
    bool grown = false;
    for (const Shape &shape : in.grown[cell])
      grown = grown || shape.cable_um > 0.0;
    for (BarsRow *row : {&out[in.type[cell]], &out.back()}) {
      row->cells++, row->cells_grown += grown, row->bars.add(counts[cell]);
      add_bars_of(bars, parent, cell, *row);
    }
  }
  out.erase(std::remove_if(out.begin(), out.end(), [](const BarsRow &row) { return !row.bars.bars(); }),
            out.end());
  return out;
}

} // namespace conceg::analyse
