// SPDX-License-Identifier: BSD-3-Clause
#include "dictionary.hpp"

#include "barcode.hpp"
#include "calibre.hpp"
#include "sections.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::characterise {
namespace {

constexpr double resample_step_um = 1.0, shortest_branch_um = 2.0; // for the straightness

glm::dvec3 unit_or(const glm::dvec3 &v, const glm::dvec3 &fallback) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : fallback;
}

void push_bar(Dictionary &d, const BarRow &row, const Calibre &calibre) {
  d.bar_birth.push_back(row.birth), d.bar_death.push_back(row.death), d.bar_parent.push_back(row.parent);
  d.bar_radius.push_back(row.radius), d.bar_taper.push_back(row.taper), d.bar_cv.push_back(calibre.cv);
  d.bar_correlation_length.push_back(calibre.correlation_length), d.bar_angle.push_back(row.angle);
  d.bar_tip_direction.push_back(row.tip_direction), d.bar_tip_distance.push_back(row.tip_distance);
}

void push_donor(Dictionary &d, const Donor &donor, double soma_radius) {
  d.donor_id.push_back(donor.id), d.donor_fold.push_back(donor.fold), d.donor_frame.push_back(donor.frame);
  d.donor_frame_kind.push_back(donor.frame_kind), d.donor_soma_radius.push_back(soma_radius);
  d.donor_pooled_from.push_back(donor.pooled_from), d.donor_trace.emplace_back(name_of(donor.trace));
  if (donor.source >= 0) d.donor_source.push_back(static_cast<std::uint32_t>(donor.source));
}

// Radii of a bar: the fork belongs to the bar that goes on there, so its radius is left out.
Calibre calibre_of(const Tree &tree, const std::vector<double> &path, const Bar &bar, CalibrePool &pool) {
  std::vector<double> at, radius;
  for (std::size_t k = 0; k < bar.nodes.size(); k++) {
    const std::size_t node = bar.nodes[k];
    at.push_back(path[node]);
    radius.push_back(tree.radius[k == 0 && bar.parent >= 0 ? bar.nodes[1] : node]);
  }
  std::vector<double> residual;
  const Calibre calibre = measure_calibre(at, radius, &residual);
  pool.add(calibre, bar.death - bar.birth, residual);
  return calibre;
}

void add_tree(Dictionary &d, const Donor &donor, const Cell &cell, const Tree &tree, CalibrePool &pool) {
  const Children children(tree.parent);
  const std::vector<double> path = path_lengths(tree);
  glm::dvec3 trunk(0.0);
  for (std::size_t i = 0; i < tree.size() && trunk == glm::dvec3(0.0); i++)
    trunk = tree.position[i] - cell.soma;
  d.tree_neurite.push_back(static_cast<std::uint8_t>(tree.neurite));
  d.tree_trunk_direction.push_back(rotate(donor.frame, unit_or(trunk, {0.0, 0.0, 1.0})));
  for (const Bar &bar : find_bars(tree)) {
    const Calibre calibre = calibre_of(tree, path, bar, pool);
    const glm::dvec3 tip = rotate(donor.frame, tree.position[bar.nodes.back()] - cell.soma);
    BarRow row{bar.birth, bar.death, calibre.radius, calibre.taper, 0.0, glm::length(tip), bar.parent, {}};
    row.tip_direction = unit_or(tip, d.tree_trunk_direction.back());
    row.tip_distance = std::max(row.tip_distance, 1e-3);
    if (bar.parent >= 0)
      row.angle = angle_between(first_segment(tree, children, bar.nodes[0], bar.nodes[1]),
                                first_segment(tree, children, bar.nodes[0], bar.rival));
    push_bar(d, row, calibre);
  }
  d.tree_bar_offset.push_back(d.bar_birth.size());
}

void sum_straightness(const Tree &tree, EntrySums &sums) {
  for (const Section &section : find_sections(tree)) {
    if (section.length < shortest_branch_um) continue;
    std::vector<glm::dvec3> line;
    for (std::size_t node : section.nodes)
      line.push_back(tree.position[node]);
    const double value = straightness(line, resample_step_um);
    sums.straight += value, sums.straight_squared += value * value, sums.branches++;
  }
}

} // namespace

void open_entry(Dictionary &d, const std::string &name, const std::string &cell_class,
                const std::string &note) {
  d.entry_name.push_back(name), d.entry_class.push_back(cell_class), d.entry_note.push_back(note);
}

CellFigures add_cell(Dictionary &d, EntrySums &sums, const Donor &donor, const Cell &cell) {
  CellFigures figures;
  push_donor(d, donor, cell.soma_radius);
  const std::size_t first_bar = d.bar_birth.size();
  std::map<int, CalibrePool> radii;
  std::map<int, std::vector<double>> traced;
  for (const Tree &tree : cell.trees) {
    add_tree(d, donor, cell, tree, radii[tree.neurite]);
    std::vector<double> &trace = traced[tree.neurite];
    trace.insert(trace.end(), tree.radius.begin(), tree.radius.end());
    figures.trees++, figures.cable += cable_length(tree);
    if (tree.neurite == neurite_axon) continue; // straightness and angles are those of the dendrites
    sum_straightness(tree, sums);
    const std::vector<double> angles = fork_angles(tree);
    sums.angles.insert(sums.angles.end(), angles.begin(), angles.end());
  }
  d.donor_tree_offset.push_back(d.tree_neurite.size());
  for (const auto &[neurite, pool] : radii) {
    EntrySums::Radii &of_entry = sums.radii[{neurite, trace_of(traced[neurite])}];
    of_entry.pool.add(pool), of_entry.donors++;
  }

  CalibrePool dendrites;
  for (const auto &[neurite, pool] : radii)
    if (neurite != neurite_axon) dendrites.add(pool);
  figures.radius = dendrites.radius();
  figures.bars = d.bar_birth.size() - first_bar;
  return figures;
}

// Of each neurite the donors that were traced most finely, so that pixels do not pass for beads.
static void put_calibres(Dictionary &d, const EntrySums &sums) {
  int last = -1;
  for (const auto &[key, radii] : sums.radii) { // by neurite, then continuous, quantised, constant
    if (key.first == last) continue;
    last = key.first;
    d.calibre_entry.push_back(static_cast<std::uint32_t>(d.entry_name.size() - 1));
    d.calibre_neurite.push_back(static_cast<std::uint8_t>(key.first));
    d.calibre_donors.push_back(radii.donors), d.calibre_trace.emplace_back(name_of(key.second));
    d.calibre_radius.push_back(radii.pool.radius()), d.calibre_cv.push_back(radii.pool.cv());
    d.calibre_correlation_length.push_back(radii.pool.correlation_length());
  }
}

void close_entry(Dictionary &d, const EntrySums &sums) {
  put_calibres(d, sums);
  const auto n = static_cast<double>(std::max<std::size_t>(1, sums.branches));
  const double mean = sums.branches ? sums.straight / n : 1.0;
  d.entry_straightness.push_back(mean);
  d.entry_straightness_sd.push_back(
      sums.branches ? std::sqrt(std::max(0.0, sums.straight_squared / n - mean * mean)) : 0.0);
  d.angle.insert(d.angle.end(), sums.angles.begin(), sums.angles.end());
  d.entry_angle_offset.push_back(d.angle.size());
  d.entry_donor_offset.push_back(d.donor_id.size());
}

void add_bar_trees(Dictionary &d, const Donor &donor, double soma_radius, const std::vector<BarTree> &trees) {
  push_donor(d, donor, soma_radius);
  for (const BarTree &tree : trees) {
    d.tree_neurite.push_back(static_cast<std::uint8_t>(tree.neurite));
    d.tree_trunk_direction.push_back(tree.trunk_direction);
    for (const BarRow &row : tree.bars)
      push_bar(d, row, Calibre{});
    d.tree_bar_offset.push_back(d.bar_birth.size());
  }
  d.donor_tree_offset.push_back(d.tree_neurite.size());
}

} // namespace conceg::characterise
