// SPDX-License-Identifier: BSD-3-Clause
// Grown cells against real cells that they were not grown from: whole distributions, held to how far real
// cells are from real cells. Plain data.
#pragma once

#include "metrics.hpp"
#include "parallel.hpp"
#include "shape.hpp"
#include "two_samples.hpp"

#include <array>
#include <string>
#include <vector>

namespace conceg::analyse {

enum class Trait { order, branch_length, straightness, local_angle, tip_path, cable };
constexpr std::size_t traits = 6;
const char *name_of(Trait trait);
const char *unit_of(Trait trait);

enum class Level { cell, branch };
const char *name_of(Level level);

// One branch; -1 where it has no such value: straightness below 2 um, an angle without a fork of two at its
// end, the path to a tip of a branch that ends with a fork. By Trait; `cable` is not of branches.
using Branch = std::array<double, 5>;
// Of dendrites, or processes of glia: all that is not axon. Angles in degree.
std::vector<Branch> branches_of(const metrics::Metrics &cell);

struct StructureCell {
  std::string donor;     // its own; of a grown cell that of which it was grown, empty = not known
  std::uint32_t set = 0; // grown cells are held against the real ones of their set: a fold
  std::vector<Branch> branches;
};

// The values of its branches, or their mean; empty without any. Of cable the sum.
std::vector<double> values_at(const StructureCell &cell, Trait trait, Level level);

struct StructureGroup {
  std::string entry;
  std::vector<StructureCell> grown, real;
};

struct StructureSettings {
  std::uint64_t seed = 1;
  std::size_t bootstraps = 1000, splits = 1000;
};

constexpr std::size_t fewest_donors = 4, many_donors = 7; // to be split at all; not to be called wide
constexpr double exceeds_rarely = 0.10, exceeds_often = 0.50, exceeds_always = 0.95; // the last of wide ones

enum class Statistic { cohens_d, sd_ratio, wasserstein, kolmogorov, auc };
constexpr std::size_t statistics = 5;
const char *name_of(Statistic statistic);

// One statistic of one trait, or of all traits together (auc).
struct StructureJudgement {
  Statistic statistic = Statistic::cohens_d;
  bool all_traits = false;
  Level level = Level::cell;
  Trait trait = Trait::order;
  double value = 0;         // of all cells; NaN = not defined
  double low = 0, high = 0; // 95 % by bootstrap over donors
  // Of halves: as many grown as real cells as two disjoint halves of the donors have. Sizes: abs(d), and the
  // factor max(r, 1 / r) of the ratio of sds.
  double halves = 0; // mean, grown against real
  double floor = 0;  // 95th percentile, real against real
  double above = 0;  // share of the halves of grown against real that are above the floor
  std::string verdict;
};

struct StructureMeans { // of one trait
  Level level = Level::cell;
  Trait trait = Trait::order;
  Side grown, real;                                    // grown: each set with the weight of its real cells
  double wasserstein = 0;                              // in the trait's unit
  double p = 0;                                        // of Kolmogorov and Smirnov, cell level
  std::vector<double> grown_quantiles, real_quantiles; // at shares 0, 0.05, ... 1
};
constexpr std::size_t quantiles = 21;

struct StructureResult {
  std::string entry;
  std::size_t grown = 0, donors = 0;                 // that are compared
  std::size_t grown_left_out = 0, real_left_out = 0; // of sets without the other side
  std::vector<StructureMeans> means;
  std::vector<StructureJudgement> judgements;
  bool wide() const { return donors < many_donors; }
};

// Throws E_RANGE when a real donor of a set is one that grown cells of the same set were grown from, or
// stands in a group twice.
void check_disjoint(const StructureGroup &group);

// A group without any real cell gets its grown means alone.
StructureResult compare_structure(StructureGroup group, const StructureSettings &settings, Workers &workers,
                                  const Progress &progress);

} // namespace conceg::analyse
