// SPDX-License-Identifier: BSD-3-Clause
#include "barcode.hpp"

namespace conceg::characterise {

std::vector<Bar> find_bars(const Tree &tree) {
  std::vector<Bar> bars;
  if (!tree.size()) return bars;
  const Children children(tree.parent);
  const std::vector<double> path = path_lengths(tree);

  // farthest[i] = path length of the farthest tip below i; survivor[i] = the child that leads to it.
  std::vector<double> farthest(path);
  std::vector<std::size_t> survivor(tree.size(), 0);
  for (std::size_t i = tree.size(); i-- > 0;)
    for (const std::size_t *child = children.begin(i); child != children.end(i); child++)
      if (!survivor[i] || farthest[*child] > farthest[i])
        farthest[i] = farthest[*child], survivor[i] = *child;

  struct Start {
    std::size_t node;
    std::int64_t parent;
  };
  std::vector<Start> starts{{0, -1}}, forks;
  while (!starts.empty()) {
    const Start start = starts.back();
    starts.pop_back();
    const auto index = static_cast<std::int64_t>(bars.size());
    Bar bar;
    bar.parent = start.parent;
    if (start.parent >= 0) {
      const auto fork = static_cast<std::size_t>(tree.parent[start.node]);
      bar.birth = path[fork];
      bar.rival = survivor[fork];
      bar.nodes.push_back(fork);
    }
    forks.clear();
    std::size_t node = start.node;
    for (;; node = survivor[node]) {
      bar.nodes.push_back(node);
      for (const std::size_t *child = children.begin(node); child != children.end(node); child++)
        if (*child != survivor[node]) forks.push_back({*child, index});
      if (!survivor[node]) break;
    }
    bar.death = path[node];
    bars.push_back(std::move(bar));
    starts.insert(starts.end(), forks.rbegin(), forks.rend());
  }
  return bars;
}

} // namespace conceg::characterise
