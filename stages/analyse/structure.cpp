// SPDX-License-Identifier: BSD-3-Clause
#include "structure.hpp"

#include "classifier.hpp"

#include "conceg/portable.h"
#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace conceg::analyse {
namespace {

constexpr double degree = 57.29577951308232;
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t folds_of_halves = 5;

using Weights = std::vector<double>; // per cell: the grown ones, then the real ones

// A group as arrays: cells in one row, grown before real.
struct Pool {
  std::vector<const StructureCell *> cells;
  std::size_t grown = 0;
  std::size_t real() const { return cells.size() - grown; }
};

Pool pool_of(const StructureGroup &group) {
  Pool pool;
  for (const StructureCell &cell : group.grown)
    pool.cells.push_back(&cell);
  pool.grown = group.grown.size();
  for (const StructureCell &cell : group.real)
    pool.cells.push_back(&cell);
  return pool;
}

std::set<std::uint32_t> sets_of(const std::vector<StructureCell> &cells) {
  std::set<std::uint32_t> out;
  for (const StructureCell &cell : cells)
    out.insert(cell.set);
  return out;
}

std::size_t leave_out_others(std::vector<StructureCell> &cells, const std::set<std::uint32_t> &sets) {
  const std::size_t before = cells.size();
  cells.erase(std::remove_if(cells.begin(), cells.end(),
                             [&](const StructureCell &cell) { return !sets.count(cell.set); }),
              cells.end());
  return before - cells.size();
}

// ---- Which cells count how much ----

struct Choice {
  Weights a, b; // grown (or one half of the real), real
};

// Every set of grown cells gets the weight of its real cells, so that what is compared is the mean over the
// sets of (grown - held back). `times` each cell is taken; the grown ones keep their number.
Choice weigh(const Pool &pool, const std::vector<double> &times) {
  std::map<std::uint32_t, double> grown, real;
  for (std::size_t i = 0; i < pool.cells.size(); i++)
    (i < pool.grown ? grown : real)[pool.cells[i]->set] += times[i];
  double count = 0, wanted = 0;
  for (const auto &[set, weight] : real)
    if (weight > 0 && grown[set] > 0) count += grown[set], wanted += weight;
  Choice out{Weights(pool.cells.size()), Weights(pool.cells.size())};
  for (std::size_t i = 0; i < pool.cells.size(); i++) {
    const std::uint32_t set = pool.cells[i]->set;
    if (i >= pool.grown)
      out.b[i] = times[i];
    else if (grown[set] > 0 && wanted > 0)
      out.a[i] = times[i] * (real[set] / grown[set]) * (count / wanted);
  }
  return out;
}

// Donors are drawn with repetition, each with its own cell and all cells grown from it: those that are real
// cells here, and the others, apart.
class Bootstrap {
public:
  explicit Bootstrap(const Pool &pool) : pool_(pool), donor_of_(pool.cells.size()) {
    std::map<std::string, std::size_t> known;
    for (std::size_t i = pool.grown; i < pool.cells.size(); i++)
      donor_of_[i] = add(known, pool.cells[i]->donor);
    real_ = donors_;
    for (std::size_t i = 0; i < pool.grown; i++)
      donor_of_[i] = add(known, pool.cells[i]->donor);
  }
  Choice draw(conceg_rng &rng) const {
    std::vector<double> times(donors_);
    for (std::size_t n = 0; n < real_; n++)
      times[conceg_rng_below(&rng, real_)]++;
    for (std::size_t n = real_; n < donors_; n++)
      times[real_ + conceg_rng_below(&rng, donors_ - real_)]++;
    std::vector<double> cells;
    for (const std::size_t donor : donor_of_)
      cells.push_back(times[donor]);
    return weigh(pool_, cells);
  }

private:
  // A cell whose donor is not known stands for itself.
  std::size_t add(std::map<std::string, std::size_t> &known, const std::string &donor) {
    if (donor.empty()) return donors_++;
    const auto [found, is_new] = known.emplace(donor, donors_);
    donors_ += is_new;
    return found->second;
  }
  const Pool &pool_;
  std::vector<std::size_t> donor_of_;
  std::size_t donors_ = 0, real_ = 0;
};

void shuffle(std::vector<std::size_t> &rows, conceg_rng &rng) {
  for (std::size_t i = rows.size(); i > 1; i--)
    std::swap(rows[i - 1], rows[conceg_rng_below(&rng, i)]);
}

struct Halves {
  std::vector<std::size_t> grown, one,
      other; // rows of cells, equally many; grown: a cell for each of `other`
};

// Grown cells are drawn without repetition, from the set of the real cell that they stand against, while
// there are any.
Halves draw_halves(const Pool &pool, conceg_rng &rng) {
  std::vector<std::size_t> real(pool.real()), grown(pool.grown);
  for (std::size_t i = 0; i < real.size(); i++)
    real[i] = pool.grown + i;
  for (std::size_t i = 0; i < grown.size(); i++)
    grown[i] = i;
  shuffle(real, rng), shuffle(grown, rng);
  std::map<std::uint32_t, std::vector<std::size_t>> by_set;
  for (const std::size_t row : grown)
    by_set[pool.cells[row]->set].push_back(row);
  Halves out;
  const std::size_t half = real.size() / 2;
  std::map<std::uint32_t, std::size_t> used;
  for (std::size_t i = 0; i < half; i++) {
    out.one.push_back(real[half + i]), out.other.push_back(real[i]);
    const std::uint32_t set = pool.cells[real[i]]->set;
    const std::vector<std::size_t> &rows = by_set[set];
    out.grown.push_back(rows[used[set]++ % rows.size()]);
  }
  return out;
}

Weights weights_of(std::size_t cells, const std::vector<std::size_t> &rows) {
  Weights out(cells);
  for (const std::size_t row : rows)
    out[row] += 1;
  return out;
}

// ---- Statistics ----

// One trait at one level.
struct Sample {
  Level level;
  Trait trait;
  ClusteredValues values;
  double real_sd = 0;
};

std::vector<Sample> samples_of(const Pool &pool) {
  std::vector<Sample> out;
  for (const Level level : {Level::cell, Level::branch})
    for (std::size_t t = 0; t < traits; t++) {
      const auto trait = static_cast<Trait>(t);
      if (level == Level::branch && trait == Trait::cable) continue;
      std::vector<std::vector<double>> clusters;
      for (const StructureCell *cell : pool.cells)
        clusters.push_back(values_at(*cell, trait, level));
      out.push_back({level, trait, ClusteredValues(clusters)});
    }
  return out;
}

// Cell means of all traits; cells without one of them are left out of the classifier.
struct Profiles {
  std::vector<std::array<double, traits>> row;
  std::vector<bool> known;
};

Profiles profiles_of(const Pool &pool) {
  Profiles out{std::vector<std::array<double, traits>>(pool.cells.size()),
               std::vector<bool>(pool.cells.size(), true)};
  for (std::size_t i = 0; i < pool.cells.size(); i++)
    for (std::size_t t = 0; t < traits; t++) {
      const std::vector<double> value = values_at(*pool.cells[i], static_cast<Trait>(t), Level::cell);
      out.known[i] = out.known[i] && !value.empty();
      out.row[i][t] = value.empty() ? 0.0 : value[0];
    }
  return out;
}

// The fold of the real cell that a donor is; of other donors the cell's own fold.
using FoldOfDonor = std::map<std::string, std::uint32_t>;
std::uint32_t origin_of(const FoldOfDonor &fold_of, const std::string &donor, std::uint32_t own) {
  const auto found = fold_of.find(donor);
  return found == fold_of.end() ? own : found->second;
}

double auc_by_sets(const Pool &pool, const Profiles &profiles, const Choice &choice) {
  FoldOfDonor fold_of;
  for (std::size_t i = pool.grown; i < pool.cells.size(); i++)
    fold_of[pool.cells[i]->donor] = pool.cells[i]->set;
  std::vector<Labelled> members;
  for (std::size_t i = 0; i < pool.cells.size(); i++) {
    const StructureCell &cell = *pool.cells[i];
    if (profiles.known[i])
      members.push_back({profiles.row[i].data(), i < pool.grown, cell.set,
                         origin_of(fold_of, cell.donor, cell.set),
                         i < pool.grown ? choice.a[i] : choice.b[i]});
  }
  return cross_validated_auc(members, traits);
}

// `a` is one of the others of `halves`, which are cut into fifths.
double auc_of_halves(const Pool &pool, const Profiles &profiles, const Halves &halves,
                     const std::vector<std::size_t> &a) {
  FoldOfDonor fold_of;
  for (std::uint32_t k = 0; k < halves.other.size(); k++)
    fold_of[pool.cells[halves.one[k]]->donor] = fold_of[pool.cells[halves.other[k]]->donor] =
        k % folds_of_halves;
  std::vector<Labelled> members;
  const auto add = [&](const std::vector<std::size_t> &rows, bool first) {
    for (std::uint32_t k = 0; k < rows.size(); k++)
      if (profiles.known[rows[k]])
        members.push_back({profiles.row[rows[k]].data(), first, k % folds_of_halves,
                           origin_of(fold_of, pool.cells[rows[k]]->donor, k % folds_of_halves)});
  };
  add(a, true), add(halves.other, false);
  return cross_validated_auc(members, traits);
}

// All statistics of one choice of cells: those of each sample, then the classifier's.
using Found = std::vector<double>;
constexpr std::size_t of_sample = 4;

Found statistics_of(const std::vector<Sample> &samples, const Weights &a, const Weights &b, double auc) {
  Found out;
  for (const Sample &sample : samples) {
    const TwoSamples two = sample.values.compare(a, b);
    out.push_back(two.cohens_d), out.push_back(two.sd_ratio);
    out.push_back(sample.real_sd > 0 ? two.wasserstein / sample.real_sd : undefined);
    out.push_back(two.kolmogorov);
  }
  out.push_back(auc);
  return out;
}

Statistic statistic_at(std::size_t i, std::size_t samples) {
  return i == samples * of_sample ? Statistic::auc : static_cast<Statistic>(i % of_sample);
}

// How large it is, whatever its direction; ratios by their logarithm.
double size_of(Statistic statistic, double value) {
  if (statistic == Statistic::sd_ratio) return value > 0 ? std::abs(conceg_log(value)) : undefined;
  return std::abs(value);
}
double shown_size(Statistic statistic, double size) {
  return statistic == Statistic::sd_ratio ? conceg_exp(size) : size;
}

std::string verdict_of(std::size_t donors, double above) {
  if (donors < fewest_donors || std::isnan(above)) return "-";
  const bool wide = donors < many_donors;
  if (above > (wide ? exceeds_always : exceeds_often)) return "outside";
  return above > exceeds_rarely || wide ? "unsure" : "within";
}

std::vector<double> column(const std::vector<Found> &rows, std::size_t i, Statistic statistic, bool sizes) {
  std::vector<double> out;
  for (const Found &row : rows)
    out.push_back(sizes ? size_of(statistic, row[i]) : row[i]);
  return out;
}

double share_above(const std::vector<double> &values, double floor) {
  double above = 0, count = 0;
  for (const double value : values)
    if (!std::isnan(value)) above += value > floor, count++;
  return count > 0 && !std::isnan(floor) ? above / count : undefined;
}

std::vector<double> quantiles_of(const Pool &pool, const Sample &sample, const Weights &weights,
                                 std::size_t begin, std::size_t end) {
  std::vector<std::pair<double, double>> all;
  double total = 0;
  for (std::size_t i = begin; i < end; i++)
    for (const double value : values_at(*pool.cells[i], sample.trait, sample.level))
      if (weights[i] > 0) all.emplace_back(value, weights[i]), total += weights[i];
  std::sort(all.begin(), all.end());
  std::vector<double> out;
  double below = 0;
  std::size_t at = 0;
  for (std::size_t q = 0; q < quantiles && !all.empty(); q++) {
    const double wanted = total * static_cast<double>(q) / static_cast<double>(quantiles - 1);
    while (at + 1 < all.size() && below + all[at].second < wanted * (1 - 1e-12))
      below += all[at++].second;
    out.push_back(q + 1 == quantiles ? all.back().first : all[at].first);
  }
  return out;
}

StructureMeans means_of(const Pool &pool, const Sample &sample, const Choice &all) {
  StructureMeans out;
  out.level = sample.level, out.trait = sample.trait;
  const TwoSamples two = sample.values.compare(all.a, all.b);
  out.grown = two.a, out.real = two.b, out.wasserstein = two.wasserstein;
  out.p = sample.level == Level::cell && two.a.count > 0 && two.b.count > 0
              ? kolmogorov_p(two.kolmogorov, two.a.count, two.b.count)
              : undefined;
  out.grown_quantiles = quantiles_of(pool, sample, all.a, 0, pool.grown);
  out.real_quantiles = quantiles_of(pool, sample, all.b, pool.grown, pool.cells.size());
  return out;
}

struct Resampled {
  std::vector<Found> bootstraps, grown, real;
};

Resampled resample(const std::string &entry, const Pool &pool, const std::vector<Sample> &samples,
                   const Profiles &profiles, const StructureSettings &settings, Workers &workers,
                   const Progress &progress) {
  Resampled out;
  out.bootstraps.resize(settings.bootstraps);
  const Bootstrap bootstrap(pool);
  const std::string what = "structure of " + entry, stream = "analyse.structure." + entry;
  report(progress, what.c_str(), 0, 2);
  workers.loop(out.bootstraps.size(), 8, [&](std::size_t b, unsigned) {
    conceg_rng rng = conceg_rng_stream(settings.seed, (stream + ".bootstrap").c_str(), b);
    const Choice choice = bootstrap.draw(rng);
    out.bootstraps[b] = statistics_of(samples, choice.a, choice.b, auc_by_sets(pool, profiles, choice));
  });
  report(progress, what.c_str(), 1, 2);
  if (pool.real() >= fewest_donors) out.grown.resize(settings.splits), out.real.resize(settings.splits);
  workers.loop(out.real.size(), 8, [&](std::size_t s, unsigned) {
    conceg_rng rng = conceg_rng_stream(settings.seed, (stream + ".split").c_str(), s);
    const Halves halves = draw_halves(pool, rng);
    const std::size_t cells = pool.cells.size();
    const Weights other = weights_of(cells, halves.other);
    out.grown[s] = statistics_of(samples, weights_of(cells, halves.grown), other,
                                 auc_of_halves(pool, profiles, halves, halves.grown));
    out.real[s] = statistics_of(samples, weights_of(cells, halves.one), other,
                                auc_of_halves(pool, profiles, halves, halves.one));
  });
  report(progress, what.c_str(), 2, 2);
  return out;
}

} // namespace

const char *name_of(Trait trait) {
  const char *const names[] = {"order", "branch_length", "straightness", "local_angle", "tip_path", "cable"};
  return names[static_cast<std::size_t>(trait)];
}
const char *unit_of(Trait trait) {
  const char *const units[] = {"1", "um", "1", "degree", "um", "um"};
  return units[static_cast<std::size_t>(trait)];
}
const char *name_of(Level level) {
  return level == Level::cell ? "cell" : "branch";
}
const char *name_of(Statistic statistic) {
  const char *const names[] = {"cohens_d", "sd_ratio", "wasserstein_in_sd", "kolmogorov_smirnov", "auc"};
  return names[static_cast<std::size_t>(statistic)];
}

std::vector<double> values_at(const StructureCell &cell, Trait trait, Level level) {
  std::vector<double> values;
  double sum = 0;
  const auto column = static_cast<std::size_t>(trait == Trait::cable ? Trait::branch_length : trait);
  for (const Branch &branch : cell.branches)
    if (branch[column] >= 0) values.push_back(branch[column]), sum += branch[column];
  if (trait == Trait::cable) return {sum}; // 0 of a cell of which nothing grew
  if (level == Level::branch || values.empty()) return values;
  return {sum / static_cast<double>(values.size())};
}

std::vector<Branch> branches_of(const metrics::Metrics &cell) {
  std::vector<Branch> out;
  std::vector<bool> wanted; // per tree
  for (const metrics::Section &s : cell.sections) {
    if (s.parent < 0) wanted.push_back(s.kind != axon_code);
    if (!wanted[s.tree]) continue;
    out.push_back({static_cast<double>(s.order), s.length, s.straightness_1um,
                   s.local_angle == metrics::none ? -1.0 : degree * s.local_angle,
                   s.children ? -1.0 : s.path_distance});
  }
  return out;
}

void check_disjoint(const StructureGroup &group) {
  std::set<std::string> held_back;
  for (const StructureCell &real : group.real) {
    if (!held_back.insert(real.donor).second)
      fail(CONCEG_E_RANGE,
           "structure: %s: expected each donor to be held back once, got %s twice; give each fold its own "
           "document",
           group.entry.c_str(), real.donor.c_str());
    for (const StructureCell &grown : group.grown)
      if (grown.set == real.set && grown.donor == real.donor)
        fail(CONCEG_E_RANGE,
             "structure: %s: expected donors that no cell was grown from, got donor %s on both sides; grow "
             "from a dictionary without it",
             group.entry.c_str(), real.donor.c_str());
  }
}

StructureResult compare_structure(StructureGroup group, const StructureSettings &settings, Workers &workers,
                                  const Progress &progress) {
  check_disjoint(group);
  StructureResult out;
  out.entry = group.entry;
  const bool published_only = group.real.empty();
  if (!published_only) {
    const std::set<std::uint32_t> grown_sets = sets_of(group.grown), real_sets = sets_of(group.real);
    out.grown_left_out = leave_out_others(group.grown, real_sets);
    out.real_left_out = leave_out_others(group.real, grown_sets);
  }
  out.grown = group.grown.size(), out.donors = group.real.size();
  if (!out.grown) return out;
  const Pool pool = pool_of(group);
  const std::vector<double> once(pool.cells.size(), 1.0);
  const Choice all = published_only ? Choice{once, Weights(once.size())} : weigh(pool, once);
  std::vector<Sample> samples = samples_of(pool);
  for (Sample &sample : samples) {
    out.means.push_back(means_of(pool, sample, all));
    sample.real_sd = out.means.back().real.sd;
  }
  if (published_only) return out;
  const Profiles profiles = profiles_of(pool);
  const Found found = statistics_of(samples, all.a, all.b, auc_by_sets(pool, profiles, all));
  const Resampled resampled = resample(group.entry, pool, samples, profiles, settings, workers, progress);
  for (std::size_t i = 0; i < found.size(); i++) {
    StructureJudgement j;
    j.statistic = statistic_at(i, samples.size()), j.all_traits = j.statistic == Statistic::auc;
    if (!j.all_traits) j.level = samples[i / of_sample].level, j.trait = samples[i / of_sample].trait;
    j.value = found[i];
    const std::vector<double> drawn = column(resampled.bootstraps, i, j.statistic, false);
    j.low = quantile_of(drawn, 0.025), j.high = quantile_of(drawn, 0.975);
    const std::vector<double> grown = column(resampled.grown, i, j.statistic, true),
                              real = column(resampled.real, i, j.statistic, true);
    const double floor = quantile_of(real, 0.95);
    j.above = share_above(grown, floor), j.verdict = verdict_of(out.donors, j.above);
    j.halves = shown_size(j.statistic, mean_of_known(grown)), j.floor = shown_size(j.statistic, floor);
    out.judgements.push_back(j);
  }
  return out;
}

} // namespace conceg::analyse
