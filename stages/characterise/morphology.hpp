// SPDX-License-Identifier: BSD-3-Clause
// A reconstruction as plain arrays: what every algorithm of this stage takes and gives. Lengths in um.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conceg::characterise {

// SWC codes of the neurites that a dictionary can hold.
enum Neurite : int { neurite_axon = 2, neurite_basal = 3, neurite_apical = 4, neurite_glia = 7 };

// One tree: node 0 is the first neurite sample, parents come before their children.
struct Tree {
  int neurite = neurite_basal;
  std::vector<glm::dvec3> position;
  std::vector<double> radius;
  std::vector<std::int64_t> parent; // -1 for node 0
  std::size_t size() const { return position.size(); }
};

struct Cell {
  glm::dvec3 soma{0.0};
  double soma_radius = 0.0;
  std::vector<Tree> trees;
};

// Children of every node, in node order: those of node i are child[first[i]] .. child[first[i + 1] - 1].
struct Children {
  std::vector<std::size_t> first, child;
  explicit Children(const std::vector<std::int64_t> &parent)
      : first(parent.size() + 1), child(parent.size()) {
    for (std::int64_t up : parent)
      if (up >= 0) first[static_cast<std::size_t>(up) + 1]++;
    for (std::size_t i = 0; i < parent.size(); i++)
      first[i + 1] += first[i];
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < parent.size(); i++)
      if (parent[i] >= 0) child[next[static_cast<std::size_t>(parent[i])]++] = i;
  }
  std::size_t count(std::size_t node) const { return first[node + 1] - first[node]; }
  const std::size_t *begin(std::size_t node) const { return child.data() + first[node]; }
  const std::size_t *end(std::size_t node) const { return child.data() + first[node + 1]; }
};

// Path length of every node from node 0.
inline std::vector<double> path_lengths(const Tree &tree) {
  std::vector<double> path(tree.size(), 0.0);
  for (std::size_t i = 1; i < tree.size(); i++) {
    const auto up = static_cast<std::size_t>(tree.parent[i]);
    path[i] = path[up] + glm::length(tree.position[i] - tree.position[up]);
  }
  return path;
}

inline double cable_length(const Tree &tree) {
  double sum = 0.0;
  for (std::size_t i = 1; i < tree.size(); i++)
    sum += glm::length(tree.position[i] - tree.position[static_cast<std::size_t>(tree.parent[i])]);
  return sum;
}

} // namespace conceg::characterise
