// SPDX-License-Identifier: BSD-3-Clause
#include "multigrid.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace conceg::analyse {

namespace {

constexpr std::size_t small_enough = 1000;
constexpr int last_sweeps = 8;
constexpr double damping = 0.7, enlarged = 1.8; // of Jacobi's steps; of the coarse correction

using Places = std::vector<Multigrid::Place>;

// Of each node the number of its group, in the order of the blocks; and the places of the groups.
std::vector<std::uint32_t> group_nodes(const WeightedGraph &graph, const Places &place, Places &places) {
  const auto block = [&](std::uint32_t i) {
    return std::array<std::uint32_t, 3>{place[i][0] / 2, place[i][1] / 2, place[i][2] / 2};
  };
  std::vector<std::uint32_t> order(graph.size()), parent(graph.size()), group(graph.size());
  std::iota(order.begin(), order.end(), 0u), std::iota(parent.begin(), parent.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto x = block(a), y = block(b);
    return x != y ? x < y : a < b;
  });
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i)
      i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < graph.size(); i++)
    for (std::uint64_t e = graph.offset[i]; e < graph.offset[i + 1]; e++)
      if (const std::uint32_t j = graph.neighbour[e]; j < i && block(i) == block(j)) {
        const std::uint32_t a = root(i), b = root(j);
        parent[std::max(a, b)] = std::min(a, b);
      }
  places.clear();
  // A root comes before the others of its group, as it has the lowest number of the block's.
  for (const std::uint32_t i : order)
    if (root(i) == i) group[i] = static_cast<std::uint32_t>(places.size()), places.push_back(block(i));
  for (std::uint32_t i = 0; i < graph.size(); i++)
    group[i] = group[root(i)];
  return group;
}

// first[g] .. first[g + 1]: nodes of group g in `member`, in their order.
void list_members(const std::vector<std::uint32_t> &group, std::size_t count,
                  std::vector<std::uint32_t> &first, std::vector<std::uint32_t> &member) {
  first.assign(count + 1, 0), member.resize(group.size());
  for (const std::uint32_t g : group)
    first[g + 1]++;
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t i = 0; i < group.size(); i++)
    member[next[group[i]]++] = i;
}

// Edges between groups: sums of those between their nodes, less what makes up for steps in place of slopes.
WeightedGraph coarse_graph(const WeightedGraph &fine, const std::vector<std::uint32_t> &group,
                           const std::vector<std::uint32_t> &first,
                           const std::vector<std::uint32_t> &member) {
  const std::size_t count = first.size() - 1;
  WeightedGraph out;
  out.offset.assign(1, 0), out.boundary.assign(count, 0);
  std::vector<std::pair<std::uint32_t, double>> edges;
  for (std::uint32_t g = 0; g < count; g++) {
    edges.clear();
    for (std::uint32_t m = first[g]; m < first[g + 1]; m++)
      for (std::uint64_t e = fine.offset[member[m]]; e < fine.offset[member[m] + 1]; e++)
        if (const std::uint32_t other = group[fine.neighbour[e]]; other != g)
          edges.emplace_back(other, fine.weight[e] / enlarged);
    std::sort(edges.begin(), edges.end());
    for (std::size_t e = 0; e < edges.size();) {
      double sum = 0;
      const std::uint32_t other = edges[e].first;
      for (; e < edges.size() && edges[e].first == other; e++)
        sum += edges[e].second;
      out.neighbour.push_back(other), out.weight.push_back(static_cast<float>(sum));
    }
    out.offset.push_back(out.neighbour.size());
  }
  return out;
}

} // namespace

Multigrid::Multigrid(WeightedGraph graph, std::vector<Place> place, Workers &workers) : workers_(workers) {
  levels_.emplace_back();
  levels_.back().graph = std::move(graph);
  while (levels_.back().graph.size() > small_enough) {
    Level &fine = levels_.back(), coarse;
    Places places;
    std::vector<std::uint32_t> group = group_nodes(fine.graph, place, places);
    if (places.size() == fine.graph.size() && place == places) break; // nothing hangs together any more
    list_members(group, places.size(), fine.first, fine.member);
    coarse.graph = coarse_graph(fine.graph, group, fine.first, fine.member);
    fine.group = std::move(group), place = std::move(places);
    levels_.push_back(std::move(coarse));
  }
  set_boundary(std::vector<double>(levels_.front().graph.size(), 0));
}

void Multigrid::set_boundary(std::vector<double> boundary) {
  levels_.front().graph.boundary = std::move(boundary);
  for (std::size_t l = 0; l < levels_.size(); l++) {
    Level &level = levels_[l];
    const WeightedGraph &graph = level.graph;
    level.inverse.assign(graph.size(), 0);
    for (std::size_t i = 0; i < graph.size(); i++) {
      double diagonal = graph.boundary[i];
      for (std::uint64_t e = graph.offset[i]; e < graph.offset[i + 1]; e++)
        diagonal += graph.weight[e];
      if (diagonal > 0) level.inverse[i] = damping / diagonal;
    }
    if (level.group.empty()) continue;
    std::vector<double> &next = levels_[l + 1].graph.boundary;
    std::fill(next.begin(), next.end(), 0.0);
    for (std::size_t i = 0; i < graph.size(); i++)
      next[level.group[i]] += graph.boundary[i] / enlarged;
  }
}

void Multigrid::apply(const Level &level, const std::vector<double> &u, std::vector<double> &out) const {
  const WeightedGraph &graph = level.graph;
  loop(graph.size(), [&](std::size_t i) {
    double sum = graph.boundary[i] * u[i];
    for (std::uint64_t e = graph.offset[i]; e < graph.offset[i + 1]; e++)
      sum += static_cast<double>(graph.weight[e]) * (u[i] - u[graph.neighbour[e]]);
    out[i] = sum;
  });
}

void Multigrid::precondition(const std::vector<double> &residual, std::vector<double> &out) {
  cycle(0, residual, out);
}

// One Jacobi step, the coarse correction, one Jacobi step.
void Multigrid::cycle(std::size_t at, const std::vector<double> &residual, std::vector<double> &out) {
  Level &level = levels_[at];
  const std::size_t size = level.graph.size();
  out.resize(size);
  if (level.group.empty()) return sweep_last(level, residual, out);
  loop(size, [&](std::size_t i) { out[i] = level.inverse[i] * residual[i]; });
  level.left.resize(size);
  apply(level, out, level.left);
  level.rest.resize(level.first.size() - 1);
  loop(level.rest.size(), [&](std::size_t g) {
    double sum = 0;
    for (std::uint32_t m = level.first[g]; m < level.first[g + 1]; m++)
      sum += residual[level.member[m]] - level.left[level.member[m]];
    level.rest[g] = sum;
  });
  cycle(at + 1, level.rest, level.out);
  if (Level &next = levels_[at + 1]; !next.group.empty()) { // once more: a W-cycle
    apply(next, level.out, next.left);
    for (std::size_t g = 0; g < level.rest.size(); g++)
      level.rest[g] -= next.left[g];
    level.again.resize(level.rest.size());
    cycle(at + 1, level.rest, level.again);
    for (std::size_t g = 0; g < level.rest.size(); g++)
      level.out[g] += level.again[g];
  }
  loop(size, [&](std::size_t i) { out[i] += level.out[level.group[i]]; });
  apply(level, out, level.left);
  loop(size, [&](std::size_t i) { out[i] += level.inverse[i] * (residual[i] - level.left[i]); });
}

// Gauss and Seidel forward and back, from zero: symmetric.
void Multigrid::sweep_last(const Level &level, const std::vector<double> &residual,
                           std::vector<double> &out) const {
  const WeightedGraph &graph = level.graph;
  std::fill(out.begin(), out.end(), 0.0);
  const auto relax = [&](std::size_t i) {
    if (!(level.inverse[i] > 0)) return;
    double sum = residual[i];
    for (std::uint64_t e = graph.offset[i]; e < graph.offset[i + 1]; e++)
      sum += static_cast<double>(graph.weight[e]) * out[graph.neighbour[e]];
    out[i] = sum * level.inverse[i] / damping;
  };
  for (int n = 0; n < last_sweeps; n++) {
    for (std::size_t i = 0; i < graph.size(); i++)
      relax(i);
    for (std::size_t i = graph.size(); i-- > 0;)
      relax(i);
  }
}

} // namespace conceg::analyse
