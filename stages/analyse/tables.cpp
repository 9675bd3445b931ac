// SPDX-License-Identifier: BSD-3-Clause
#include "tables.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace conceg::analyse {

std::vector<std::string> classes_of(const Cells &cells) {
  std::vector<std::string> names;
  for (const std::string &name : cells.type_class)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double um_per_um3_to_mm_per_mm3 = 1e6;

double soma_volume(const Cells &cells, std::size_t cell) {
  const double r = cells.soma_radius[cell];
  return 4.0 / 3.0 * pi * r * r * r;
}

Cable all_of(const CellCable &kinds) {
  Cable sum;
  for (const Cable &kind : kinds)
    sum.add(kind);
  return sum;
}

using Chosen = std::function<bool(std::size_t cell)>;

Chosen of_class(const Cells &cells, const std::string &name) {
  return [&cells, name](std::size_t cell) { return cells.type_class[cells.type[cell]] == name; };
}
Chosen of_type(const Cells &cells, std::size_t type) {
  return [&cells, type](std::size_t cell) { return cells.type[cell] == type; };
}

// Cable of cells that stand elsewhere: no cells of this box.
Chosen passing_axons(const Cells &cells) {
  return [&cells](std::size_t cell) {
    return cells.type_class[cells.type[cell]] == "axon" && !(cells.soma_radius[cell] > 0);
  };
}

// Sums over the chosen cells.
struct Sums {
  std::uint64_t cells = 0;
  double soma_radius = 0, soma_volume = 0, volume = 0, area = 0;
  Cable cable;
  BarCount bars;
};

Sums sum_of(const Cells &cells, const Measures &m, const Chosen &chosen) {
  Sums sums;
  for (std::size_t cell = 0; cell < cells.type.size(); cell++) {
    if (!chosen(cell)) continue;
    sums.cells++;
    sums.soma_radius += cells.soma_radius[cell], sums.soma_volume += soma_volume(cells, cell);
    if (!m.sizes.empty()) sums.volume += m.sizes[cell].volume, sums.area += m.sizes[cell].area;
    if (!m.cable.empty()) sums.cable.add(all_of(m.cable[cell]));
    if (!m.bars.empty()) sums.bars.add(m.bars[cell]);
  }
  return sums;
}

void put_sums(Table &table, const Measures &m, const Sums &sums) {
  table.put("cells", sums.cells);
  table.put("soma_radius", sums.cells ? sums.soma_radius / static_cast<double>(sums.cells) : 0, "um");
  table.put("soma_volume", sums.soma_volume, "um^3");
  if (!m.sizes.empty()) {
    table.put("volume", sums.volume, "um^3");
    table.put("surface", sums.area, "um^2");
    table.put("volume_fraction", sums.volume / m.box_volume, "1");
  }
  if (!m.cable.empty()) {
    table.put("cable", sums.cable.length, "um");
    table.put("cable_density", um_per_um3_to_mm_per_mm3 * sums.cable.length / m.box_volume, "mm mm^-3");
    table.put("mean_radius", sums.cable.mean_radius(), "um");
  }
}

void put_bars(Table &table, const BarCount &bars) {
  const char *const states[] = {"waiting", "done", "short", "lost", "handed"};
  table.put("bars", bars.bars());
  for (std::size_t s = 0; s < 5; s++)
    table.put(states[s], bars.state[s]);
  table.put("asked", bars.asked, "um");
  table.put("achieved", bars.achieved, "um");
  table.put("missing", bars.missing, "um");
}

// Share of pyramidal cells whose apical tips lie, on the mean, on the pia's side of the soma.
void put_apical(const Cells &cells, const Measures &m,
                const std::function<void(const char *, double, const char *)> &row) {
  std::uint64_t with_tips = 0, upward = 0, tips = 0, pia_side = 0;
  for (std::size_t cell = 0; cell < m.shape.apical.size(); cell++) {
    const Apical &apical = m.shape.apical[cell];
    if (!apical.tips || cells.type_class[cells.type[cell]] != "pyramidal") continue;
    with_tips++, upward += apical.rise > 0, tips += apical.tips, pia_side += apical.pia_side;
  }
  if (!with_tips) return;
  row("apical_cells_pia_side", static_cast<double>(upward) / static_cast<double>(with_tips), "1");
  row("apical_tips_pia_side", static_cast<double>(pia_side) / static_cast<double>(tips), "1");
}

void put_spread(Table &table, const std::string &group, const char *measure,
                const std::vector<double> &values, const char *unit) {
  const Spread spread = spread_of(values);
  table.put("class", group);
  table.put("measure", std::string(measure));
  table.put("count", spread.count);
  table.put("mean", spread.mean, "");
  table.put("sd", spread.sd, "");
  table.put("unit", std::string(unit));
}

} // namespace

double mesh_fraction(const Measures &m) {
  double volume = 0;
  for (const Size &size : m.sizes)
    volume += size.volume;
  return volume / m.box_volume;
}

double largest_difference(const Measures &m) {
  std::vector<double> shares;
  if (!m.sizes.empty()) shares.push_back(mesh_fraction(m));
  if (m.field.voxels) shares.push_back(m.field.soma + m.field.neurite);
  if (m.points.points) shares.push_back(m.points.inside);
  return shares.empty() ? 0
                        : *std::max_element(shares.begin(), shares.end()) -
                              *std::min_element(shares.begin(), shares.end());
}

Table summary_table(const Cells &cells, const Measures &m) {
  Table table("summary");
  const auto row = [&](const char *name, double value, const char *unit) {
    table.put("name", std::string(name));
    table.put("value", value, "");
    table.put("unit", std::string(unit));
  };
  const Sums sums = sum_of(cells, m, [](std::size_t) { return true; });
  const auto axons = static_cast<double>(sum_of(cells, m, passing_axons(cells)).cells);
  const double others = static_cast<double>(sums.cells) - axons;
  row("box_volume", m.box_volume, "um^3");
  row("cells", others, "1");
  row("cell_density", others / m.box_volume, "um^-3");
  if (axons > 0) row("passing_axons", axons, "1");
  if (!m.sizes.empty()) row("icvf_mesh", mesh_fraction(m), "1");
  if (m.field.voxels) row("icvf_field", m.field.soma + m.field.neurite, "1");
  if (m.points.points)
    row("icvf_points", m.points.inside, "1"), row("icvf_points_standard_error", m.points.standard_error, "1");
  if (!m.sizes.empty()) row("icvf_largest_difference", largest_difference(m), "1");
  if (m.points.points) row("points_in_several_cells", static_cast<double>(m.points.in_several), "1");
  if (m.field.voxels) {
    row("field_step", m.field_step, "um");
    row("soma_fraction", m.field.soma, "1");
    row("neurite_fraction", m.field.neurite, "1");
    row("ecs_fraction", 1 - m.field.soma - m.field.neurite, "1");
  }
  if (m.pores.voxels) {
    row("ecs_distance_mean", m.pores.mean, "um"), row("ecs_distance_median", m.pores.median, "um");
    row("ecs_distance_95_percent", m.pores.p95, "um"), row("ecs_distance_beyond_band", m.pores.beyond, "1");
    row("ecs_cleft_width", m.pores.cleft_width(), "um");
  }
  if (!m.sizes.empty()) {
    row("volume", sums.volume, "um^3"), row("surface", sums.area, "um^2");
    row("surface_density", sums.area / m.box_volume, "um^-1");
  }
  if (!m.cable.empty()) {
    row("cable", sums.cable.length, "um");
    row("cable_density", um_per_um3_to_mm_per_mm3 * sums.cable.length / m.box_volume, "mm mm^-3");
    row("mean_radius", sums.cable.mean_radius(), "um");
    put_apical(cells, m, row);
  }
  if (!m.bars.empty()) {
    row("bars", static_cast<double>(sums.bars.bars()), "1");
    row("bars_done", static_cast<double>(sums.bars.state[1]), "1");
    row("bars_asked", sums.bars.asked, "um");
    row("bars_achieved", sums.bars.achieved, "um");
    row("bars_missing", sums.bars.missing, "um");
  }
  return table;
}

Table class_table(const Cells &cells, const Measures &m) {
  Table table("class");
  for (const std::string &name : classes_of(cells)) {
    table.put("class", name);
    put_sums(table, m, sum_of(cells, m, of_class(cells, name)));
  }
  return table;
}

Table type_table(const Cells &cells, const Measures &m) {
  Table table("type");
  for (std::size_t type = 0; type < cells.type_name.size(); type++) {
    table.put("type", cells.type_name[type]);
    table.put("class", cells.type_class[type]);
    put_sums(table, m, sum_of(cells, m, of_type(cells, type)));
  }
  return table;
}

Table cell_table(const Cells &cells, const Measures &m) {
  Table table("cell");
  for (std::size_t cell = 0; cell < cells.type.size(); cell++) {
    table.put("id", cells.id[cell]);
    table.put("type", cells.type_name[cells.type[cell]]);
    table.put("soma_radius", static_cast<double>(cells.soma_radius[cell]), "um");
    table.put("soma_volume", soma_volume(cells, cell), "um^3");
    if (!m.sizes.empty()) {
      table.put("volume", m.sizes[cell].volume, "um^3");
      table.put("neurite_volume", std::max(0.0, m.sizes[cell].volume - soma_volume(cells, cell)), "um^3");
      table.put("surface", m.sizes[cell].area, "um^2");
    }
    if (!m.cable.empty()) {
      const Cable cable = all_of(m.cable[cell]);
      table.put("cable", cable.length, "um");
      table.put("mean_radius", cable.mean_radius(), "um");
    }
    if (!m.bars.empty()) {
      table.put("bars", m.bars[cell].bars());
      table.put("bars_done", m.bars[cell].state[1]);
      table.put("asked", m.bars[cell].asked, "um");
      table.put("missing", m.bars[cell].missing, "um");
    }
  }
  return table;
}

Table neurite_table(const Cells &cells, const Measures &m) {
  const char *const names[] = {"other", "axon", "basal dendrite", "apical dendrite", "glial process"};
  Table table("neurite");
  for (const std::string &name : classes_of(cells))
    for (std::size_t kind = 0; kind < neurite_kinds.size() && !m.cable.empty(); kind++) {
      Cable sum;
      for (std::size_t cell = 0; cell < cells.type.size(); cell++)
        if (of_class(cells, name)(cell)) sum.add(m.cable[cell][kind]);
      if (!(sum.length > 0)) continue;
      table.put("class", name);
      table.put("neurite", std::string(names[kind]));
      table.put("cable", sum.length, "um");
      table.put("cable_density", um_per_um3_to_mm_per_mm3 * sum.length / m.box_volume, "mm mm^-3");
      table.put("mean_radius", sum.mean_radius(), "um");
    }
  return table;
}

Table bars_table(const Cells &cells, const Measures &m) {
  Table table("bars");
  if (m.bars.empty()) return table;
  for (std::size_t type = 0; type < cells.type_name.size(); type++) {
    table.put("type", cells.type_name[type]);
    put_bars(table, sum_of(cells, m, of_type(cells, type)).bars);
  }
  table.put("type", std::string("all"));
  put_bars(table, sum_of(cells, m, [](std::size_t) { return true; }).bars);
  return table;
}

Table morphometry_table(const Cells &cells, const Measures &m) {
  Table table("morphometry");
  if (m.shape.apical.empty()) return table;
  for (const std::string &name : classes_of(cells)) {
    const Chosen chosen = of_class(cells, name);
    std::vector<double> order, length, straight, angle, sections(cells.type.size(), 0), per_cell;
    for (const Section &section : m.shape.sections) {
      if (!chosen(section.cell)) continue;
      order.push_back(section.order), length.push_back(section.length), sections[section.cell]++;
      if (section.straightness >= 0) straight.push_back(section.straightness);
    }
    for (const Fork &fork : m.shape.forks)
      if (chosen(fork.cell)) angle.push_back(fork.angle);
    for (std::size_t cell = 0; cell < cells.type.size(); cell++)
      if (chosen(cell)) per_cell.push_back(sections[cell]);
    put_spread(table, name, "branches_per_cell", per_cell, "1");
    put_spread(table, name, "branch_order", order, "1");
    put_spread(table, name, "branch_length", length, "um");
    put_spread(table, name, "branch_straightness", straight, "1");
    put_spread(table, name, "branch_angle", angle, "rad");
  }
  return table;
}

} // namespace conceg::analyse
