// SPDX-License-Identifier: BSD-3-Clause
#include "sections.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <cmath>

namespace conceg::characterise {

std::vector<Section> find_sections(const Tree &tree) {
  std::vector<Section> sections;
  if (!tree.size()) return sections;
  const Children children(tree.parent);
  struct Start {
    std::size_t child;
    std::int64_t section;
  };
  std::vector<Start> starts{{0, -1}};
  while (!starts.empty()) {
    const Start start = starts.back();
    starts.pop_back();
    Section section;
    section.parent = start.section;
    std::size_t node = start.child;
    if (start.section >= 0) {
      section.order = sections[static_cast<std::size_t>(start.section)].order + 1;
      section.nodes.push_back(static_cast<std::size_t>(tree.parent[node]));
    }
    section.nodes.push_back(node);
    while (children.count(node) == 1)
      section.nodes.push_back(node = *children.begin(node));
    for (std::size_t i = 1; i < section.nodes.size(); i++)
      section.length += glm::length(tree.position[section.nodes[i]] - tree.position[section.nodes[i - 1]]);
    const auto index = static_cast<std::int64_t>(sections.size());
    for (const std::size_t *child = children.end(node); child != children.begin(node);)
      starts.push_back({*--child, index});
    sections.push_back(std::move(section));
  }
  return sections;
}

glm::dvec3 first_segment(const Tree &tree, const Children &children, std::size_t node, std::size_t child) {
  for (;;) {
    const glm::dvec3 d = tree.position[child] - tree.position[node];
    const double length = glm::length(d);
    if (length > 0.0) return d / length;
    if (children.count(child) != 1) return glm::dvec3(0.0);
    child = *children.begin(child);
  }
}

double angle_between(const glm::dvec3 &a, const glm::dvec3 &b) {
  return conceg_atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

std::vector<double> fork_angles(const Tree &tree) {
  std::vector<double> angles;
  const Children children(tree.parent);
  for (std::size_t node = 0; node < tree.size(); node++) {
    if (children.count(node) != 2) continue;
    const glm::dvec3 a = first_segment(tree, children, node, children.begin(node)[0]);
    const glm::dvec3 b = first_segment(tree, children, node, children.begin(node)[1]);
    if (a != glm::dvec3(0.0) && b != glm::dvec3(0.0)) angles.push_back(angle_between(a, b));
  }
  return angles;
}

} // namespace conceg::characterise
