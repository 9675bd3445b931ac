// SPDX-License-Identifier: BSD-3-Clause
#include "shape.hpp"

#include <algorithm>
#include <vector>

namespace conceg::analyse {
namespace {

constexpr double degree = 57.29577951308232;

// The rows that start on each bar, by their start.
std::vector<std::vector<std::size_t>> children_of(const BarList &bars) {
  std::vector<std::vector<std::size_t>> children(bars.count);
  for (std::size_t i = 0; i < bars.count; i++)
    if (bars.parent[i] >= 0) children[static_cast<std::size_t>(bars.parent[i])].push_back(i);
  for (std::vector<std::size_t> &rows : children)
    std::stable_sort(rows.begin(), rows.end(),
                     [&](std::size_t a, std::size_t b) { return bars.start[a] < bars.start[b]; });
  return children;
}

void add_branch(Shape &sum, int order, double length_um) {
  sum.branches++, sum.order += order, sum.cable_um += length_um;
}

} // namespace

double Shape::mean_angle_degree() const {
  return degree * angle_rad / static_cast<double>(bifurcations);
}

Shape shape_of(const metrics::Metrics &cell, Part part) {
  Shape sum;
  std::vector<bool> wanted; // per tree
  for (const metrics::Section &section : cell.sections) {
    if (section.parent < 0) wanted.push_back((section.kind == axon_code) == (part == Part::axon));
    if (!wanted[section.tree]) continue;
    add_branch(sum, section.order, section.length);
    sum.tips += !section.children;
    if (section.local_angle != metrics::none) sum.bifurcations++, sum.angle_rad += section.local_angle;
    if (section.straightness_1um == metrics::none) continue;
    const double value = section.straightness_1um;
    sum.judged++, sum.straightness += value, sum.straightness_squared += value * value;
  }
  return sum;
}

void add_bars(const BarList &bars, const std::uint8_t *chosen, Shape &sum) {
  const std::vector<std::vector<std::size_t>> children = children_of(bars);
  std::vector<int> first(bars.count, 1); // order of the branch that a bar starts with
  for (std::size_t i = 0; i < bars.count; i++) {
    if (chosen && !chosen[i]) continue;
    int order = first[i];
    double from = bars.start[i];
    const std::vector<std::size_t> &starting = children[i];
    for (std::size_t k = 0; k < starting.size();) {
      const double fork = bars.start[starting[k]];
      add_branch(sum, order++, fork - from);
      from = fork;
      const std::size_t one = k;
      for (; k < starting.size() && bars.start[starting[k]] == fork; k++)
        first[starting[k]] = order;
      if (k - one == 1) sum.bifurcations++, sum.angle_rad += bars.angle[starting[one]];
    }
    add_branch(sum, order, bars.end[i] - from);
    sum.tips++;
  }
}

} // namespace conceg::analyse
