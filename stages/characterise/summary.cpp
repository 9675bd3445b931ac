// SPDX-License-Identifier: BSD-3-Clause
#include "summary.hpp"

#include "published.hpp"

#include <cmath>
#include <cstdio>

namespace conceg::characterise {
namespace {

constexpr double degree = 57.29577951308232;

// All branches of all cells as one sample.
MeanSd pooled(const std::vector<CellRow> &cells, metrics::Spread CellRow::*what) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (const CellRow &cell : cells) {
    const metrics::Spread &s = cell.*what;
    const auto n = static_cast<double>(s.count);
    count += n, sum += n * s.mean, squares += n * (s.sd * s.sd + s.mean * s.mean);
  }
  if (!(count > 0.0)) return {};
  const double mean = sum / count;
  return {static_cast<std::size_t>(count), mean, std::sqrt(std::max(0.0, squares / count - mean * mean))};
}

MeanSd over_cells(const std::vector<CellRow> &cells, double CellRow::*what) {
  std::vector<double> values;
  for (const CellRow &cell : cells)
    values.push_back(cell.*what);
  return mean_of(values);
}

std::string written(const char *format, double mean, double sd) {
  char text[64];
  std::snprintf(text, sizeof text, format, mean, sd);
  return text;
}
std::string written(const char *format, const MeanSd &value) {
  return value.count ? written(format, value.mean, value.sd) : "-";
}

std::string line_of(const std::string &name, const std::string &cells,
                    const std::vector<std::string> &fields) {
  static const int width[] = {15, 15, 15, 15, 15, 15};
  std::string line = name;
  line.resize(std::max<std::size_t>(line.size(), 22), ' ');
  const auto add = [&](const std::string &field, int columns) {
    const auto wide = static_cast<std::size_t>(columns);
    line += std::string(field.size() < wide ? wide - field.size() : 1, ' ') + field;
  };
  add(cells, 6);
  for (std::size_t i = 0; i < fields.size(); i++)
    add(fields[i], width[i]);
  return line;
}

} // namespace

CellRow row_of(const metrics::Group &g, double soma_radius_um, double radius_um) {
  CellRow row;
  row.order = g.order.mean, row.length_um = g.section_length.mean,
  row.angle_degree = g.local_angle.mean * degree, row.remote_angle_degree = g.remote_angle.mean * degree;
  row.tips = static_cast<double>(g.tips), row.stems = static_cast<double>(g.trees), row.cable_um = g.length;
  row.soma_radius_um = soma_radius_um, row.radius_um = radius_um;
  row.straightness = g.straightness, row.straightness_1um = g.straightness_1um;
  row.tip_straightness = g.tip_straightness;
  return row;
}

struct Summary::Figures {
  MeanSd order, length, straightness, straightness_1um, tip_straightness, angle, remote_angle, tips, stems,
      cable, soma, radius;
};

Summary::Figures Summary::figures_of(const Entry &entry) {
  const std::vector<CellRow> &c = entry.cells;
  Figures f;
  f.order = over_cells(c, &CellRow::order), f.length = over_cells(c, &CellRow::length_um);
  f.straightness = pooled(c, &CellRow::straightness),
  f.straightness_1um = pooled(c, &CellRow::straightness_1um),
  f.tip_straightness = pooled(c, &CellRow::tip_straightness);
  f.angle = over_cells(c, &CellRow::angle_degree),
  f.remote_angle = over_cells(c, &CellRow::remote_angle_degree);
  f.tips = over_cells(c, &CellRow::tips), f.stems = over_cells(c, &CellRow::stems),
  f.cable = over_cells(c, &CellRow::cable_um);
  f.soma = over_cells(c, &CellRow::soma_radius_um), f.radius = over_cells(c, &CellRow::radius_um);
  return f;
}

Table Summary::table() const {
  Table t("entry_summary");
  const auto put = [&](const std::string &name, const MeanSd &value, const char *unit) {
    t.put(name.c_str(), value.mean, unit), t.put((name + "_sd").c_str(), value.sd, unit);
  };
  for (const Entry &entry : entries_) {
    const Figures f = figures_of(entry);
    t.put("entry", entry.name);
    t.put("cells", std::uint64_t{entry.cells.size()}), t.put("pooled", std::uint64_t{entry.pooled});
    put("order", f.order, "1"), t.put("order_from_0", f.order.mean - 1.0, "1");
    put("branch_length", f.length, "um"), put("straightness", f.straightness, "1");
    put("straightness_1um", f.straightness_1um, "1"), put("tip_straightness", f.tip_straightness, "1");
    put("local_angle", f.angle, "degree"), put("remote_angle", f.remote_angle, "degree");
    put("tips", f.tips, "1"), put("stems", f.stems, "1"), put("cable", f.cable, "um");
    put("soma_radius", f.soma, "um"), put("radius", f.radius, "um");
  }
  return t;
}

std::vector<std::string> Summary::lines() const {
  std::vector<std::string> out = {
      line_of("dendrites or processes", "cells",
              {"order", "branch um", "straightness", "soma to tip", "angle degree", "cable mm"})};
  for (const Entry &entry : entries_) {
    const Figures f = figures_of(entry);
    out.push_back(
        line_of(entry.name + (entry.pooled ? "*" : ""), std::to_string(entry.cells.size()),
                {written("%.2f +- %.2f", f.order), written("%.1f +- %.1f", f.length),
                 written("%.2f +- %.2f", f.straightness), written("%.2f +- %.2f", f.tip_straightness),
                 written("%.0f +- %.0f", f.angle),
                 written("%.2f +- %.2f", {f.cable.count, 1e-3 * f.cable.mean, 1e-3 * f.cable.sd})}));
    const Published *published_entry = find_published(entry.name);
    if (!published_entry) continue;
    const PublishedRow &paper = published_entry->real;
    out.push_back(line_of("  paper", std::to_string(paper.cells),
                          {written("%.2f +- %.2f", paper.order, paper.order_sd),
                           written("%.1f +- %.1f", paper.length_um, paper.length_sd_um),
                           written("%.2f +- %.2f", paper.straightness, paper.straightness_sd), "-",
                           written("%.0f +- %.0f", paper.angle_degree, paper.angle_sd_degree)}));
    bool far = false;
    const auto apart = [&](const MeanSd &ours, double theirs, double sd) {
      if (!ours.count) return std::string("-");
      const double z = (ours.mean - theirs) / sd;
      far = far || std::abs(z) > 1.0;
      return written(std::abs(z) > 1.0 ? "(!) %+.1f sd" : "%+.1f sd", z, 0.0);
    };
    out.push_back(line_of("  difference", "",
                          {apart(f.order, paper.order, paper.order_sd),
                           apart(f.length, paper.length_um, paper.length_sd_um),
                           apart(f.straightness, paper.straightness, paper.straightness_sd), "-",
                           apart(f.angle, paper.angle_degree, paper.angle_sd_degree)}));
    if (far)
      out.push_back("  (!) more than 1 sd from the paper; in the default dictionary: " +
                    std::string(published_entry->explained ? published_entry->explained
                                                           : "no difference of this kind"));
  }
  out.emplace_back("Order counts from 1 at the root branch (NeuroM's from 0: one less). Order, branch and "
                   "angle: mean and sd of "
                   "the cells' means; straightness: of all branches and tips.");
  for (const Entry &entry : entries_)
    if (entry.pooled) {
      out.emplace_back("* with " + std::to_string(entry.pooled) + " of " +
                       std::to_string(entry.cells.size()) + " cells from another group (donor_pooled_from)");
      break;
    }
  return out;
}

} // namespace conceg::characterise
