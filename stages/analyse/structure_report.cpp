// SPDX-License-Identifier: BSD-3-Clause
#include "structure_report.hpp"

#include "published.hpp"
#include "report_lines.hpp"

#include <cmath>
#include <utility>

namespace conceg::analyse {
namespace {

constexpr std::size_t field_width = 22;

// The columns of the printed table.
struct Shown {
  Trait trait;
  const char *title;
  int digits;
  double scale;
};
constexpr Shown shown[] = {
    {Trait::order, "order", 2, 1.0},
    {Trait::branch_length, "branch um", 1, 1.0},
    {Trait::straightness, "straightness", 3, 1.0},
    {Trait::local_angle, "angle degree", 1, 1.0},
    {Trait::tip_path, "path to tips um", 0, 1.0},
    {Trait::cable, "cable mm", 2, 1e-3},
};

// Mean and sd that the paper publishes; of straightness they are of branches, of the rest of cells.
bool published_value(const PublishedRow &row, Trait trait, MeanSd &out) {
  out.count = row.cells;
  switch (trait) {
  case Trait::order:
    out.mean = row.order, out.sd = row.order_sd;
    return true;
  case Trait::branch_length:
    out.mean = row.length_um, out.sd = row.length_sd_um;
    return true;
  case Trait::straightness:
    out.mean = row.straightness, out.sd = row.straightness_sd;
    return true;
  case Trait::local_angle:
    out.mean = row.angle_degree, out.sd = row.angle_sd_degree;
    return true;
  default:
    return false;
  }
}
Level published_level(Trait trait) {
  return trait == Trait::straightness ? Level::branch : Level::cell;
}

const StructureMeans *find(const StructureResult &r, Level level, Trait trait) {
  for (const StructureMeans &m : r.means)
    if (m.level == level && m.trait == trait) return &m;
  return nullptr;
}

// Against means and sds alone: d with its standard error (Hedges and Olkin 1985), and the ratio of sds. At
// both levels, as the paper does not say of which its sd is.
std::vector<StructureJudgement> against_published(const StructureResult &r) {
  std::vector<StructureJudgement> out;
  const Published *paper = find_published(r.entry);
  if (r.donors || !paper) return out;
  for (const StructureMeans &m : r.means) {
    MeanSd real;
    if (!published_value(paper->real, m.trait, real)) continue;
    const double a = m.grown.count, b = static_cast<double>(real.count);
    const double variance = ((a - 1) * m.grown.sd * m.grown.sd + (b - 1) * real.sd * real.sd) / (a + b - 2);
    StructureJudgement j;
    j.level = m.level, j.trait = m.trait, j.verdict = "-";
    j.halves = j.floor = j.above = NAN;
    j.value = (m.grown.mean - real.mean) / std::sqrt(variance);
    const double error = std::sqrt((a + b) / (a * b) + j.value * j.value / (2 * (a + b)));
    j.low = j.value - 1.96 * error, j.high = j.value + 1.96 * error;
    out.push_back(j);
    j.statistic = Statistic::sd_ratio, j.value = m.grown.sd / real.sd, j.low = j.high = NAN;
    out.push_back(j);
  }
  return out;
}

const std::vector<StructureJudgement> &judged(const StructureResult &r,
                                              std::vector<StructureJudgement> &own) {
  if (r.donors) return r.judgements;
  own = against_published(r);
  return own;
}

// Tables hold finite numbers: -1 where there is none, 0 for a signed one.
double known(double value, double none) {
  return std::isnan(value) ? none : value;
}

// ---- Lines ----

std::string mean_field(const Side &s, const Shown &c) {
  if (!(s.count > 0)) return "-";
  if (s.count < 2) return formatted("%.*f", c.digits, c.scale * s.mean);
  return formatted("%.*f +- %.*f", c.digits, c.scale * s.mean, c.digits, c.scale * s.sd);
}

template <class Field> std::vector<std::string> fields_of(Field field) {
  std::vector<std::string> out;
  for (const Shown &column : shown)
    out.push_back(field(column));
  return out;
}

std::string cells_text(double count) {
  return formatted("%.0f", count);
}

void add_means(const StructureResult &r, Level level, std::vector<std::string> &out) {
  const std::string what = level == Level::cell ? ", cells" : ", branches";
  const auto side = [&](Side StructureMeans::*which) {
    return fields_of([&](const Shown &c) {
      const StructureMeans *m = find(r, level, c.trait);
      return m ? mean_field(m->*which, c) : std::string("-");
    });
  };
  const StructureMeans *first = find(r, level, Trait::order);
  if (!first) return;
  out.push_back(
      line_of("  grown" + what, cells_text(first->grown.count), side(&StructureMeans::grown), field_width));
  if (r.donors)
    out.push_back(
        line_of("  real" + what, cells_text(first->real.count), side(&StructureMeans::real), field_width));
}

void add_paper(const StructureResult &r, std::vector<std::string> &out) {
  const Published *paper = find_published(r.entry);
  if (!paper) return;
  for (const auto &[name, row] :
       {std::pair<const char *, const PublishedRow *>{"  paper, ConCeG", &paper->grown},
        {"  paper, real", &paper->real}})
    out.push_back(line_of(name, std::to_string(row->cells), fields_of([row = row](const Shown &c) {
                            MeanSd m;
                            if (!published_value(*row, c.trait, m)) return std::string("-");
                            return formatted("%.*f +- %.*f", c.digits, c.scale * m.mean, c.digits,
                                             c.scale * m.sd);
                          }),
                          field_width));
}

const StructureJudgement *find(const std::vector<StructureJudgement> &all, Level level, Trait trait,
                               Statistic statistic) {
  for (const StructureJudgement &j : all)
    if (!j.all_traits && j.level == level && j.trait == trait && j.statistic == statistic) return &j;
  return nullptr;
}

std::string value_field(const StructureJudgement &j) {
  if (std::isnan(j.value)) return "-";
  const char *const format = j.statistic == Statistic::cohens_d ? "%+.2f" : "%.2f";
  std::string out = formatted(format, j.value);
  if (!std::isnan(j.low)) out += " [" + formatted(format, j.low) + " " + formatted(format, j.high) + "]";
  return out;
}
std::string floor_field(const StructureJudgement &j) {
  if (std::isnan(j.floor) || std::isnan(j.halves)) return "-";
  return formatted("%.2f of %.2f, %.0f %%", j.halves, j.floor, 100 * j.above);
}

// The worst of a trait's statistics.
std::string verdict_of(const std::vector<StructureJudgement> &all, Level level, Trait trait) {
  std::string worst = "-";
  for (const StructureJudgement &j : all) {
    if (j.all_traits || j.level != level || j.trait != trait || j.verdict == "-") continue;
    if (j.verdict == "outside" || worst == "-" || (j.verdict == "unsure" && worst == "within"))
      worst = j.verdict;
  }
  return worst;
}

void add_statistics(const StructureResult &r, Level level, std::vector<std::string> &out) {
  std::vector<StructureJudgement> own;
  const std::vector<StructureJudgement> &all = judged(r, own);
  const char *const titles[] = {"d", "sd ratio", "W1 in sd", "KS"};
  const std::string what = level == Level::cell ? ", cells" : ", branches";
  for (std::size_t s = 0; s < 4; s++) {
    const auto statistic = static_cast<Statistic>(s);
    bool any = false;
    const auto line = [&](const auto &field) {
      return fields_of([&](const Shown &c) {
        const StructureJudgement *j = find(all, level, c.trait, statistic);
        any = any || j;
        return j ? field(*j) : std::string("-");
      });
    };
    const std::vector<std::string> values = line(value_field), floors = line(floor_field);
    if (!any) continue;
    out.push_back(line_of(std::string("  ") + titles[s] + what, "", values, field_width));
    if (r.donors >= fewest_donors) out.push_back(line_of("    halves, floor", "", floors, field_width));
  }
  if (!r.donors) return;
  out.push_back(line_of("  verdict" + what, "",
                        fields_of([&](const Shown &c) { return verdict_of(all, level, c.trait); }),
                        field_width));
}

void add_classifier(const StructureResult &r, std::vector<std::string> &out) {
  for (const StructureJudgement &j : r.judgements)
    if (j.all_traits)
      out.push_back(line_of("  AUC of all, cells", "", {value_field(j)}, field_width) +
                    (std::isnan(j.floor) ? "" : "; halves " + floor_field(j)) + "; " + j.verdict);
}

// "3: one two / three four", by set.
void add_donors(const StructureInput &input, const StructureResult &r, std::vector<std::string> &out) {
  for (std::uint32_t set = 0; set < input.sets; set++) {
    std::string grown, held_back;
    for (const StructureDonor &d : input.donors)
      if (d.entry == r.entry && d.set == set) (d.held_back ? held_back : grown) += " " + d.donor;
    if (held_back.empty() && r.donors) held_back = " none, so this set is left out";
    out.push_back("  set " + std::to_string(set) + ": grown from" + (grown.empty() ? " nobody" : grown) +
                  (held_back.empty() ? "" : "; held back" + held_back));
  }
}

std::string heading(const StructureResult &r) {
  if (!r.donors) return r.entry + ": no real cell; against the published row";
  return r.entry + ": " + std::to_string(r.donors) + (r.donors == 1 ? " donor" : " donors") +
         (r.wide() ? ": wide" : "");
}

} // namespace

Table structure_means_table(const std::vector<StructureResult> &results) {
  Table table("structure_means");
  const auto put = [&](const std::string &name, double mean, double sd) {
    table.put((name + "_mean").c_str(), mean, ""), table.put((name + "_sd").c_str(), sd, "");
  };
  for (const StructureResult &r : results) {
    const Published *paper = find_published(r.entry);
    for (const StructureMeans &m : r.means) {
      table.put("entry", r.entry), table.put("level", std::string(name_of(m.level)));
      table.put("trait", std::string(name_of(m.trait))), table.put("unit", std::string(unit_of(m.trait)));
      table.put("donors", std::uint64_t{r.donors});
      table.put("grown_count", m.grown.count, "1"), put("grown", m.grown.mean, m.grown.sd);
      table.put("real_count", m.real.count, "1"), put("real", m.real.mean, m.real.sd);
      table.put("wasserstein", known(m.wasserstein, -1), ""), table.put("p", known(m.p, -1), "1");
      MeanSd grown, real;
      const bool told = paper && m.level == published_level(m.trait) &&
                        published_value(paper->grown, m.trait, grown) &&
                        published_value(paper->real, m.trait, real);
      put("paper_grown", told ? grown.mean : -1.0, told ? grown.sd : -1.0);
      put("paper_real", told ? real.mean : -1.0, told ? real.sd : -1.0);
    }
  }
  return table;
}

Table structure_table(const std::vector<StructureResult> &results) {
  Table table("structure");
  for (const StructureResult &r : results) {
    std::vector<StructureJudgement> own;
    for (const StructureJudgement &j : judged(r, own)) {
      if (std::isnan(j.value)) continue;
      table.put("entry", r.entry);
      table.put("level", std::string(j.all_traits ? "cell" : name_of(j.level)));
      table.put("trait", std::string(j.all_traits ? "all" : name_of(j.trait)));
      table.put("statistic", std::string(name_of(j.statistic)));
      table.put("against", std::string(r.donors ? "held back" : "published"));
      table.put("grown", std::uint64_t{r.grown}), table.put("donors", std::uint64_t{r.donors});
      table.put("value", j.value, "1"), table.put("low", known(j.low, j.value), "1"),
          table.put("high", known(j.high, j.value), "1");
      table.put("halves", known(j.halves, -1), "1"), table.put("floor", known(j.floor, -1), "1");
      table.put("above", known(j.above, -1), "1");
      table.put("wide", std::string(r.wide() ? "yes" : "no")), table.put("verdict", j.verdict);
    }
  }
  return table;
}

Table structure_quantile_table(const std::vector<StructureResult> &results) {
  Table table("structure_quantile");
  for (const StructureResult &r : results)
    for (const StructureMeans &m : r.means) {
      if (m.grown_quantiles.empty() || m.real_quantiles.empty()) continue;
      for (std::size_t q = 0; q < quantiles; q++) {
        table.put("entry", r.entry), table.put("level", std::string(name_of(m.level)));
        table.put("trait", std::string(name_of(m.trait))), table.put("unit", std::string(unit_of(m.trait)));
        table.put("share", static_cast<double>(q) / static_cast<double>(quantiles - 1), "1");
        table.put("grown", m.grown_quantiles[q], ""), table.put("real", m.real_quantiles[q], "");
      }
    }
  return table;
}

std::vector<std::string> structure_lines(const StructureInput &input,
                                         const std::vector<StructureResult> &results) {
  std::vector<std::string> titles, out;
  for (const Shown &column : shown)
    titles.emplace_back(column.title);
  out.push_back(line_of("structure", "", titles, field_width));
  for (const StructureResult &r : results) {
    if (!r.grown) continue;
    out.push_back(heading(r));
    for (const Level level : {Level::cell, Level::branch})
      add_means(r, level, out);
    add_paper(r, out);
    for (const Level level : {Level::cell, Level::branch})
      add_statistics(r, level, out);
    add_classifier(r, out);
    add_donors(input, r, out);
  }
  for (const char *line :
       {"Mean +- sd of the cells' means and of all branches (forks of two, tips); the paper's straightness "
        "is of branches, the rest of cells.",
        "Grown minus real, [95 % by bootstrap over donors]. d: Cohen's; W1: first Wasserstein distance over "
        "the real sd; KS: largest difference of the distributions; AUC: of a linear discriminant on all six.",
        "Halves, floor: the mean of as many grown as real cells as two halves of the donors have, and the "
        "95th percentile of half against half of the donors; then the share of halves above that floor.",
        "Verdict: outside where more than half of them are (wide, of fewer than 7 donors: 95 %), within "
        "where at most a tenth is (chance: 5 %; wide: never), else unsure. Of a trait: the worst of its "
        "statistics."})
    out.emplace_back(line);
  return out;
}

} // namespace conceg::analyse
