// SPDX-License-Identifier: BSD-3-Clause
#include "paths.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace conceg::analyse {

namespace {

constexpr float far = std::numeric_limits<float>::infinity();
constexpr long straight = 3; // voxels around the start whose distance is taken as a straight line

// Indices on the periodic grid.
class Grid {
public:
  explicit Grid(const OpenVoxels &v) : v_(v) {}
  std::array<std::size_t, 3> at(std::size_t i) const {
    const std::size_t row = i / v_.shape[2], x = row / v_.shape[1];
    return {x, row - x * v_.shape[1], i - row * v_.shape[2]};
  }
  std::size_t index(const std::array<std::size_t, 3> &p, const std::array<long, 3> &by) const {
    std::array<std::size_t, 3> q = {};
    for (std::size_t a = 0; a < 3; a++) {
      const auto n = static_cast<long>(v_.shape[a]);
      long to = static_cast<long>(p[a]) + by[a]; // steps are shorter than two boxes
      while (to < 0)
        to += n;
      while (to >= n)
        to -= n;
      q[a] = static_cast<std::size_t>(to);
    }
    return (q[0] * v_.shape[1] + q[1]) * v_.shape[2] + q[2];
  }
  std::size_t next(const std::array<std::size_t, 3> &p, std::size_t axis, long by) const {
    std::array<long, 3> step = {0, 0, 0};
    step[axis] = by;
    return index(p, step);
  }
  double length(const std::array<long, 3> &by) const {
    double squared = 0;
    for (std::size_t a = 0; a < 3; a++)
      squared += std::pow(static_cast<double>(by[a]) * v_.spacing[a], 2);
    return std::sqrt(squared);
  }
  // Shortest distance over the faces of the box, um.
  double apart(std::size_t i, std::size_t j) const {
    const std::array<std::size_t, 3> p = at(i), q = at(j);
    std::array<long, 3> by = {};
    for (std::size_t a = 0; a < 3; a++) {
      const auto n = static_cast<long>(v_.shape[a]), d = static_cast<long>(q[a]) - static_cast<long>(p[a]);
      by[a] = d - n * std::lround(static_cast<double>(d) / static_cast<double>(n));
    }
    return length(by);
  }

private:
  const OpenVoxels &v_;
};

using Entry = std::pair<float, std::size_t>; // length, voxel: ties by the lower voxel
using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

// The larger root of sum a_k (t - b_k)^2 = 1 over the terms, which are dropped from the last one on where t
// would not lie behind them.
struct Term {
  double weight, base, nearest;
};
double solved(std::array<Term, 3> &terms) {
  const auto order = [&](std::size_t i, std::size_t j) {
    if (terms[j].nearest < terms[i].nearest) std::swap(terms[i], terms[j]);
  };
  order(0, 1), order(1, 2), order(0, 1);
  double best = std::numeric_limits<double>::infinity();
  double a = 0, b = 0, c = -1;
  for (const Term &t : terms) {
    if (t.nearest >= best) break; // also the terms of axes without a settled neighbour
    a += t.weight, b += t.weight * t.base, c += t.weight * t.base * t.base;
    const double root = b * b - a * c;
    if (root < 0) break;
    best = (b + std::sqrt(root)) / a;
  }
  return best;
}

// Length at a voxel from the settled ones around it.
double length_at(const OpenVoxels &v, const Grid &grid, const std::vector<float> &length,
                 const std::vector<std::uint8_t> &settled, std::size_t i) {
  const std::array<std::size_t, 3> p = grid.at(i);
  constexpr Term nothing = {0, 0, std::numeric_limits<double>::infinity()};
  std::array<Term, 3> terms = {nothing, nothing, nothing};
  for (std::size_t axis = 0; axis < 3; axis++) {
    if (v.shape[axis] == 1) continue;
    Term &best = terms[axis];
    for (const long side : {-1L, 1L}) {
      const std::size_t one = grid.next(p, axis, side), two = grid.next(p, axis, 2 * side);
      if (!settled[one]) continue;
      const auto near = static_cast<double>(length[one]);
      if (near >= best.nearest) continue;
      const double h = v.spacing[axis];
      best = {1 / (h * h), near, near};
      if (settled[two] && length[two] <= length[one]) { // (3 t - 4 near + beyond) / (2 h)
        const auto beyond = static_cast<double>(length[two]);
        best = {2.25 / (h * h), (4 * near - beyond) / 3, near};
      }
    }
  }
  return solved(terms);
}

// True when all voxels that a straight line between two voxels near each other can touch are open.
bool all_open(const OpenVoxels &v, const Grid &grid, const std::array<std::size_t, 3> &from,
              const std::array<long, 3> &by) {
  std::array<long, 3> lo = {}, hi = {};
  for (std::size_t a = 0; a < 3; a++)
    lo[a] = std::min(0L, by[a]), hi[a] = std::max(0L, by[a]);
  for (long x = lo[0]; x <= hi[0]; x++)
    for (long y = lo[1]; y <= hi[1]; y++)
      for (long z = lo[2]; z <= hi[2]; z++)
        if (!v.open[grid.index(from, {x, y, z})]) return false;
  return true;
}

std::array<long, 3> reach_of(const OpenVoxels &v, long most) {
  std::array<long, 3> out = {};
  for (std::size_t a = 0; a < 3; a++)
    out[a] = v.shape[a] == 1 ? 0 : std::min(most, static_cast<long>(v.shape[a] - 1) / 2);
  return out;
}

template <class Visit> void box_around(const std::array<long, 3> &reach, const Visit &visit) {
  for (long x = -reach[0]; x <= reach[0]; x++)
    for (long y = -reach[1]; y <= reach[1]; y++)
      for (long z = -reach[2]; z <= reach[2]; z++)
        if (x || y || z) visit(std::array<long, 3>{x, y, z});
}

} // namespace

std::vector<float> marched_lengths(const OpenVoxels &voxels, std::size_t start) {
  const Grid grid(voxels);
  std::vector<float> length(voxels.open.size(), far);
  std::vector<std::uint8_t> settled(voxels.open.size(), 0);
  Queue queue;
  const auto offer = [&](std::size_t i, double value) {
    if (!voxels.open[i] || settled[i] || !(static_cast<float>(value) < length[i])) return;
    length[i] = static_cast<float>(value);
    queue.push({length[i], i});
  };
  offer(start, 0);
  const std::array<std::size_t, 3> from = grid.at(start);
  box_around(reach_of(voxels, straight), [&](const std::array<long, 3> &by) {
    if (all_open(voxels, grid, from, by)) offer(grid.index(from, by), grid.length(by));
  });
  while (!queue.empty()) {
    const auto [value, i] = queue.top();
    queue.pop();
    if (settled[i] || value > length[i]) continue;
    settled[i] = 1;
    const std::array<std::size_t, 3> p = grid.at(i);
    for (std::size_t axis = 0; axis < 3; axis++)
      for (const long side : {-1L, 1L}) {
        const std::size_t j = grid.next(p, axis, side);
        if (voxels.shape[axis] > 1 && voxels.open[j] && !settled[j])
          offer(j, std::max(static_cast<double>(value), length_at(voxels, grid, length, settled, j)));
      }
  }
  return length;
}

std::vector<float> stepped_lengths(const OpenVoxels &voxels, std::size_t start, int neighbours) {
  const Grid grid(voxels);
  const long most_axes = neighbours == 6 ? 1 : neighbours == 18 ? 2 : 3;
  std::vector<std::array<long, 3>> steps;
  box_around(reach_of(voxels, 1), [&](const std::array<long, 3> &by) {
    if (std::abs(by[0]) + std::abs(by[1]) + std::abs(by[2]) <= most_axes) steps.push_back(by);
  });
  std::vector<double> length(voxels.open.size(), std::numeric_limits<double>::infinity());
  using Wide = std::pair<double, std::size_t>;
  std::priority_queue<Wide, std::vector<Wide>, std::greater<>> queue;
  if (voxels.open[start]) length[start] = 0, queue.push({0, start});
  while (!queue.empty()) {
    const auto [value, i] = queue.top();
    queue.pop();
    if (value > length[i]) continue;
    const std::array<std::size_t, 3> p = grid.at(i);
    for (const std::array<long, 3> &by : steps) {
      const std::size_t j = grid.index(p, by);
      const double there = value + grid.length(by);
      if (!(there < length[j]) || !all_open(voxels, grid, p, by)) continue;
      length[j] = there;
      queue.push({there, j});
    }
  }
  return std::vector<float>(length.begin(), length.end());
}

PathStraightness path_straightness(const OpenVoxels &voxels, const PathSettings &settings, Workers &workers,
                                   const Progress &progress) {
  const Grid grid(voxels);
  PathStraightness out;
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < voxels.open.size(); i++)
    if (voxels.open[i]) open.push_back(i);
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; a++)
    if (voxels.shape[a] > 1)
      shortest = std::min(shortest, voxels.spacing[a] * static_cast<double>(voxels.shape[a]));
  if (open.empty() || !(settings.least < 0.5 * shortest)) return out;
  struct OfStart {
    std::vector<double> marched, stepped;
    std::uint64_t pairs = 0, apart = 0;
  };
  std::vector<OfStart> found(settings.starts);
  report(progress, "paths", 0, settings.starts);
  workers.loop(found.size(), 1, [&](std::size_t s, unsigned) {
    conceg_rng rng = conceg_rng_stream(settings.seed, "analyse.paths", s);
    const std::size_t start = open[conceg_rng_below(&rng, open.size())];
    const std::vector<float> marched = marched_lengths(voxels, start),
                             stepped = stepped_lengths(voxels, start, 26);
    OfStart &mine = found[s];
    for (std::uint64_t tries = 0; tries < 100 * settings.ends && mine.pairs < settings.ends; tries++) {
      const std::size_t end = open[conceg_rng_below(&rng, open.size())];
      const double euclid = grid.apart(start, end);
      if (euclid < settings.least) continue;
      mine.pairs++;
      if (!(marched[end] < far)) {
        mine.apart++;
        continue;
      }
      mine.marched.push_back(std::min(1.0, euclid / static_cast<double>(marched[end])));
      mine.stepped.push_back(euclid / static_cast<double>(stepped[end]));
    }
  });
  std::vector<double> marched, stepped;
  for (const OfStart &f : found) {
    marched.insert(marched.end(), f.marched.begin(), f.marched.end());
    stepped.insert(stepped.end(), f.stepped.begin(), f.stepped.end());
    out.pairs += f.pairs, out.apart += f.apart;
  }
  out.marched = distribution(std::move(marched)), out.stepped = distribution(std::move(stepped));
  return out;
}

} // namespace conceg::analyse
