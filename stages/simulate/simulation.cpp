// SPDX-License-Identifier: BSD-3-Clause
#include "simulation.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <atomic>
#include <chrono>

namespace conceg::simulate {

namespace {

constexpr std::size_t blocks_between = 64; // that checkpoints may be written
constexpr int attempts = 5;
constexpr int attempt_shift = 48; // a walker's number stays below, its attempt above

// Puts the results of walkers `first` .. into their places.
void store(const Timeline &timeline, const std::vector<Walk> &walks, std::size_t first, Walked &walked) {
  Walkers &all = walked.walkers;
  for (std::size_t i = 0; i < walks.size(); i++) {
    const Walk &w = walks[i];
    const std::size_t at = first + i;
    std::copy(w.vector.begin(), w.vector.end(),
              all.vector.begin() + static_cast<std::ptrdiff_t>(at * timeline.shapes));
    for (std::size_t t = 0; t < w.displacement.size(); t++)
      all.displacement[t * all.count + at] = w.displacement[t];
    if (!all.weight.empty()) all.weight[at] = w.weight;
    walked.place[at] = w.place, walked.inside[at] = w.inside;
  }
}

void prepare(const Plan &plan, Walked &walked) {
  const std::size_t count = plan.walkers, blocks = (count + Walked::block - 1) / Walked::block;
  if (!walked.done.empty()) return;
  walked.done.assign(blocks, 0), walked.tally.assign(blocks, Tally());
  walked.place.resize(count), walked.inside.resize(count);
  walked.walkers.count = count;
  walked.walkers.vector.resize(count * plan.timeline.shapes);
  walked.walkers.displacement.resize(count * plan.timeline.records());
  if (plan.physics.intra.relaxation_rate > 0.0 || plan.physics.extra.relaxation_rate > 0.0)
    walked.walkers.weight.assign(count, 1.0);
}

} // namespace

void walk_all(const Plan &plan, const Walls &walls, const Seeds &seeds, Walked &walked, Workers &workers,
              const Progress &progress, const Keep &keep) {
  prepare(plan, walked);
  std::vector<std::size_t> waiting;
  for (std::size_t b = 0; b < walked.done.size(); b++)
    if (!walked.done[b]) waiting.push_back(b);
  std::atomic<std::uint64_t> finished{plan.walkers -
                                      std::min<std::uint64_t>(plan.walkers, waiting.size() * Walked::block)};
  auto last_kept = std::chrono::steady_clock::now();
  const std::size_t round =
      keep ? blocks_between * workers.threads() : std::max<std::size_t>(1, waiting.size());
  for (std::size_t begin = 0; begin < waiting.size(); begin += round) {
    const std::size_t many = std::min(round, waiting.size() - begin);
    const auto walk_block = [&](std::size_t i, unsigned) {
      const std::size_t b = waiting[begin + i], first = b * Walked::block;
      const std::size_t count = std::min<std::size_t>(Walked::block, plan.walkers - first);
      std::vector<Start> start;
      for (std::size_t w = first; w < first + count; w++)
        start.push_back({walls.local(seeds.position[w]), seeds.cell[w] >= 0, w});
      store(plan.timeline,
            walk(walls, plan.timeline, plan.physics, start.data(), count, plan.seed, walked.tally[b]), first,
            walked);
      walked.done[b] = 1;
      report(progress, "walking", finished += count, plan.walkers);
    };
    try {
      workers.loop(many, 1, walk_block);
    } catch (...) {
      if (keep) keep(walked);
      throw;
    }
    const auto now = std::chrono::steady_clock::now();
    if (keep && (now - last_kept > std::chrono::seconds(20) || begin + many == waiting.size()))
      keep(walked), last_kept = now;
  }
}

Lost find_leaks(const Plan &plan, const Walls &walls, const Seeds &seeds, const Locate &locate,
                Walked &walked, Workers &workers, const Progress &progress) {
  const bool passable = !plan.physics.permeability.empty();
  std::vector<std::uint64_t> open(plan.walkers), next;
  for (std::uint64_t i = 0; i < plan.walkers; i++)
    open[i] = i;
  Lost lost;
  for (int attempt = 1;; attempt++) {
    std::vector<std::uint8_t> leaked(open.size());
    constexpr std::size_t batch = 256;
    workers.loop((open.size() + batch - 1) / batch, 1, [&](std::size_t b, unsigned) {
      const std::size_t begin = b * batch, end = std::min(open.size(), begin + batch);
      glm::dvec3 point[batch];
      std::int64_t cell[batch];
      for (std::size_t i = begin; i < end; i++)
        point[i - begin] = walls.position(walked.place[open[i]]);
      locate(point, end - begin, cell);
      for (std::size_t i = begin; i < end; i++)
        leaked[i] = passable ? (cell[i - begin] >= 0) != (walked.inside[open[i]] != 0)
                             : cell[i - begin] != seeds.cell[open[i]];
    });
    next.clear();
    for (std::size_t i = 0; i < open.size(); i++)
      if (leaked[i]) next.push_back(open[i]);
    if (attempt == 1) lost.leaks = next.size();
    if (next.empty() || attempt > attempts) return lost;
    open.swap(next);
    lost.reruns += open.size();
    report(progress, "walking again", 0, open.size());
    std::vector<Tally> tally(workers.threads());
    workers.loop(open.size(), 1, [&](std::size_t i, unsigned worker) {
      const Start start{walls.local(seeds.position[open[i]]), seeds.cell[open[i]] >= 0,
                        open[i] | static_cast<std::uint64_t>(attempt) << attempt_shift};
      store(plan.timeline, walk(walls, plan.timeline, plan.physics, &start, 1, plan.seed, tally[worker]),
            open[i], walked);
    });
    for (const Tally &t : tally)
      walked.tally.front().add(t);
  }
}

bool is_closed(const std::vector<glm::uvec3> &face, std::size_t begin, std::size_t end) {
  std::uint64_t sum = 0;
  const auto edge = [](std::uint32_t a, std::uint32_t b) {
    return conceg_rng_mix(std::uint64_t{a} << 32 | b);
  };
  for (std::size_t f = begin; f < end; f++)
    for (int k = 0; k < 3; k++) {
      const std::uint32_t a = face[f][k], b = face[f][(k + 1) % 3];
      sum += edge(a, b) - edge(b, a);
    }
  return sum == 0;
}

} // namespace conceg::simulate
