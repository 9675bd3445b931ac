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
}

// Radii of a bar: the fork belongs to the bar that goes on there, so its radius is left out.
Calibre calibre_of(const Tree &tree, const std::vector<double> &path, const Bar &bar) {
  std::vector<double> at, radius;
  for (std::size_t k = 0; k < bar.nodes.size(); k++) {
    const std::size_t node = bar.nodes[k];
    at.push_back(path[node]);
    radius.push_back(tree.radius[k == 0 && bar.parent >= 0 ? bar.nodes[1] : node]);
  }
  return measure_calibre(at, radius);
}

void add_tree(Dictionary &d, const Donor &donor, const Cell &cell, const Tree &tree) {
  const Children children(tree.parent);
  const std::vector<double> path = path_lengths(tree);
  glm::dvec3 trunk(0.0);
  for (std::size_t i = 0; i < tree.size() && trunk == glm::dvec3(0.0); i++)
    trunk = tree.position[i] - cell.soma;
  d.tree_neurite.push_back(static_cast<std::uint8_t>(tree.neurite));
  d.tree_trunk_direction.push_back(rotate(donor.frame, unit_or(trunk, {0.0, 0.0, 1.0})));
  for (const Bar &bar : find_bars(tree)) {
    const Calibre calibre = calibre_of(tree, path, bar);
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

void measure_tree(const Tree &tree, EntrySums &sums, CellFigures &figures) {
  for (const Section &section : find_sections(tree)) {
    figures.sections++, figures.order += section.order, figures.length += section.length;
    if (section.length < shortest_branch_um) continue;
    std::vector<glm::dvec3> line;
    for (std::size_t node : section.nodes)
      line.push_back(tree.position[node]);
    const double value = straightness(line, resample_step_um);
    sums.straight += value, sums.straight_squared += value * value, sums.branches++;
    figures.straight += value, figures.forks++;
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
  std::vector<double> angles;
  for (const Tree &tree : cell.trees) {
    add_tree(d, donor, cell, tree);
    figures.trees++, figures.cable += cable_length(tree);
    if (tree.neurite == neurite_axon) continue; // figures and angles are those of the dendrites
    measure_tree(tree, sums, figures);
    const std::vector<double> more = fork_angles(tree);
    angles.insert(angles.end(), more.begin(), more.end());
  }
  d.donor_tree_offset.push_back(d.tree_neurite.size());
  sums.angles.insert(sums.angles.end(), angles.begin(), angles.end());

  const auto mean = [](double sum, std::size_t n) { return n ? sum / static_cast<double>(n) : 0.0; };
  double angle_sum = 0.0, radius_sum = 0.0, length_sum = 0.0;
  for (double a : angles)
    angle_sum += a;
  for (std::size_t b = first_bar; b < d.bar_birth.size(); b++) {
    const double length = d.bar_death[b] - d.bar_birth[b];
    radius_sum += d.bar_radius[b] * length, length_sum += length;
  }
  figures.bars = d.bar_birth.size() - first_bar;
  figures.straight = mean(figures.straight, figures.forks);
  figures.forks = angles.size();
  figures.order = mean(figures.order, figures.sections),
  figures.length = mean(figures.length, figures.sections);
  figures.angle = mean(angle_sum, angles.size());
  figures.radius = length_sum > 0.0 ? radius_sum / length_sum : 0.0;
  return figures;
}

void close_entry(Dictionary &d, const EntrySums &sums) {
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
