// SPDX-License-Identifier: BSD-3-Clause
// Grown cells against the donors that they were grown from and against the dictionary.
#pragma once

#include "bars.hpp"
#include "mean_sd.hpp"
#include "shape.hpp"

#include <array>
#include <string>
#include <vector>

namespace conceg::analyse {

constexpr std::size_t parts = 2;
using Shapes = std::array<Shape, parts>; // by Part

struct Donor {
  Shapes shapes;
  bool held_back = false;
};
struct Entry {
  std::string name;
  double straightness = 0, straightness_sd = 0; // of the branches of all its donors
  std::vector<Donor> donors;
  bool has_held_back() const;
};

struct CompareInput {
  std::vector<Entry> entries;
  std::vector<std::string> type_name, type_entry; // per type; an entry of "" is not compared
  std::vector<std::uint32_t> type;                // per cell
  std::vector<Shapes> grown;                      // per cell
  std::vector<Shapes> drawn;                      // per cell, what it was asked to grow; empty = not known
};

enum class Measure { order, branch_length, local_angle, cable, tips, straightness };
const char *name_of(Measure measure);
const char *unit_of(Measure measure);

// Of two means. 0 where one of them has no values; no error with fewer than two.
struct Difference {
  std::uint64_t count = 0; // values of the smaller side
  double mean = 0, standard_error = 0;
  double in_sd = 0; // over the sd of all donors of the entry; 0 when that is 0
};
struct ComparisonRow {
  std::size_t type = 0;
  std::string entry;
  Part part = Part::dendrites;
  Measure measure = Measure::order;
  MeanSd grown, drawn, donors; // over cells (straightness: over branches); donors: those that are compared
  Difference from_drawn, from_donors;
  std::string against; // what `within` speaks of: drawn, entry or held back; "-" when there is no bar
  std::string within;  // yes, no, unsure or "-"
};

// How near is near enough.
constexpr double straightness_tolerance = 0.02, tolerance_in_sd = 0.2, bars_done_wanted = 0.95;

// By type, part and measure; parts that nobody has are left out.
std::vector<ComparisonRow> compare(const CompareInput &input);

// Shares of the asked bars of one type, or of all ("all").
struct BarsRow {
  std::string type;
  std::uint64_t cells = 0, cells_grown = 0; // grown: with some cable
  BarCount bars;
  std::uint64_t reached = 0; // done, or handed on and ending where asked
  std::uint64_t forks = 0;   // bars that began on another bar
  double start_bias = 0;     // um, sum over those of achieved - asked start
  double share(std::uint64_t count) const;
  double length_ratio() const; // achieved / asked
  double mean_start_bias_um() const;
  bool within() const { return share(bars.state[1]) >= bars_done_wanted; }
};
// `parent`: rows within the cell, -1 = root bar. Types without bars are left out.
std::vector<BarsRow> compare_bars(const CompareInput &input, const Bars &bars,
                                  const std::vector<std::int64_t> &parent);

} // namespace conceg::analyse
