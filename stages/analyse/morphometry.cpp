// SPDX-License-Identifier: BSD-3-Clause
#include "morphometry.hpp"

#include "conceg/portable.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::analyse {

namespace {

constexpr double resample_step = 1.0, shortest_path = 2.0; // um

// One cell's trees with children lists; rows are local.
struct Tree {
  const glm::dvec3 *position;
  const std::int64_t *parent;
  std::size_t size;
  std::vector<std::uint32_t> offset, child;
  std::uint32_t children(std::size_t i) const { return offset[i + 1] - offset[i]; }
};

Tree tree_of(const Skeletons &s, std::size_t cell) {
  const std::size_t first = s.cell_offset[cell];
  Tree tree = {s.position.data() + first, s.parent.data() + first, s.cell_offset[cell + 1] - first, {}, {}};
  tree.offset.assign(tree.size + 1, 0);
  for (std::size_t i = 0; i < tree.size; i++)
    if (tree.parent[i] >= 0) tree.offset[static_cast<std::size_t>(tree.parent[i]) + 1]++;
  for (std::size_t i = 0; i < tree.size; i++)
    tree.offset[i + 1] += tree.offset[i];
  tree.child.resize(tree.offset[tree.size]);
  std::vector<std::uint32_t> next(tree.offset.begin(), tree.offset.end() - 1);
  for (std::size_t i = 0; i < tree.size; i++)
    if (tree.parent[i] >= 0)
      tree.child[next[static_cast<std::size_t>(tree.parent[i])]++] = static_cast<std::uint32_t>(i);
  return tree;
}

void measure_sections(const Tree &tree, std::uint32_t cell, std::vector<Section> &out) {
  // Order of the section that starts below a point: that of the point's own section, and one more below a
  // fork.
  std::vector<int> order(tree.size, 1);
  for (std::size_t i = 0; i < tree.size; i++) {
    const std::int64_t parent = tree.parent[i];
    if (parent >= 0)
      order[i] =
          order[static_cast<std::size_t>(parent)] + (tree.children(static_cast<std::size_t>(parent)) > 1);
    const bool starts = parent < 0 || tree.children(static_cast<std::size_t>(parent)) > 1;
    if (!starts) continue;
    std::vector<glm::dvec3> line;
    if (parent >= 0) line.push_back(tree.position[parent]);
    std::size_t end = i;
    line.push_back(tree.position[end]);
    while (tree.children(end) == 1)
      line.push_back(tree.position[end = tree.child[tree.offset[end]]]);
    Section section = {cell, order[i], 0, -1, tree.children(end) == 0};
    for (std::size_t k = 1; k < line.size(); k++)
      section.length += glm::distance(line[k], line[k - 1]);
    if (section.length >= shortest_path) section.straightness = straightness(line, resample_step);
    out.push_back(section);
  }
}

// Unit vector of the first segment below `point` through `child` that has a length; 0 when there is none.
glm::dvec3 first_segment(const Tree &tree, std::size_t point, std::size_t child) {
  for (;;) {
    const glm::dvec3 along = tree.position[child] - tree.position[point];
    const double length = glm::length(along);
    if (length > 0) return along / length;
    if (tree.children(child) != 1) return glm::dvec3(0);
    child = tree.child[tree.offset[child]];
  }
}

void measure_forks(const Tree &tree, std::uint32_t cell, std::vector<Fork> &out) {
  for (std::size_t i = 0; i < tree.size; i++) {
    if (tree.children(i) != 2) continue;
    const glm::dvec3 a = first_segment(tree, i, tree.child[tree.offset[i]]);
    const glm::dvec3 b = first_segment(tree, i, tree.child[tree.offset[i] + 1]);
    if (glm::length(a) > 0 && glm::length(b) > 0)
      out.push_back({cell, conceg_atan2(glm::length(glm::cross(a, b)), glm::dot(a, b))});
  }
}

} // namespace

Morphometry measure_shape(const Cells &cells, const Skeletons &skeletons) {
  Morphometry out;
  out.apical.resize(cells.type.size());
  for (std::uint32_t cell = 0; cell < cells.type.size(); cell++) {
    const Tree tree = tree_of(skeletons, cell);
    measure_sections(tree, cell, out.sections);
    measure_forks(tree, cell, out.forks);
    for (std::size_t i = 0; i < tree.size; i++) {
      if (skeletons.kind[skeletons.cell_offset[cell] + i] != 4 || tree.children(i) > 0) continue;
      const double rise = glm::dot(tree.position[i] - cells.soma[cell], cells.pia);
      out.apical[cell].tips++, out.apical[cell].pia_side += rise > 0, out.apical[cell].rise += rise;
    }
  }
  return out;
}

Spread spread_of(const std::vector<double> &values) {
  Spread s;
  s.count = values.size();
  if (values.empty()) return s;
  for (const double v : values)
    s.mean += v;
  s.mean /= static_cast<double>(values.size());
  double square = 0;
  for (const double v : values)
    square += (v - s.mean) * (v - s.mean);
  s.sd = std::sqrt(square / static_cast<double>(values.size()));
  return s;
}

} // namespace conceg::analyse
