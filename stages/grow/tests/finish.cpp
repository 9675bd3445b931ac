// SPDX-License-Identifier: BSD-3-Clause
// Second growth: what stands stays, bars that were not done go on from their tips, those that found no room
// look again.
#include "check.h"
#include "world.hpp"

#include <functional>

using namespace conceg::grow;

namespace {

World crowded() {
  World world;
  world.make_box(20, true);
  for (int i = 0; i < 8; i++) {
    world.add_cell({5.0 + 9.0 * (i & 1), 5.0 + 9.0 * (i >> 1 & 1), 5.0 + 9.0 * (i >> 2)}, 2.0);
    world.add_random_trees(8, 6, 80, 0.8, static_cast<std::uint64_t>(i));
  }
  world.make_network(1.0, 0.2, 1.25);
  return world;
}

// Gives up at once, so that bars stay short and forks are lost.
Parameters hasty() {
  Parameters parameters;
  parameters.retries = 0;
  return parameters;
}

// What relaxation might do: the points of a cell are carried along a smooth wave.
Skeleton moved(const World &world, Skeleton skeleton, double by_um) {
  for (std::size_t c = 0; c + 1 < skeleton.cell_offset.size(); c++)
    for (std::size_t i = skeleton.cell_offset[c]; i < skeleton.cell_offset[c + 1]; i++) {
      if (skeleton.parent[i] < 0) continue;
      const double phase = 0.3 * (skeleton.position[i].x + skeleton.position[i].y) + static_cast<double>(c);
      skeleton.position[i].z += by_um * conceg_sin(phase);
    }
  CHECK_EQUAL(skeleton.cell_offset.size(), world.cell_id.size() + 1);
  return skeleton;
}

struct Second {
  Skeleton before;
  BarReport bars_before;
  Grown after;
  double deepest_before = 0.0;
};

Second finish(const World &world, const Parameters &first, unsigned threads, double by_um) {
  Second out;
  const Grown grown = grow_world(world, first);
  out.before = moved(world, grown.skeleton, by_um), out.bars_before = grown.bars;
  out.deepest_before = deepest_overlap(world, out.before);
  State &state = out.after.state;
  state.input = world.input();
  Earlier &earlier = state.input.earlier;
  earlier.rows = out.before.position.size(), earlier.cell_offset = out.before.cell_offset.data();
  earlier.position = &out.before.position[0].x, earlier.radius = out.before.radius.data();
  earlier.target_radius = out.before.target_radius.data();
  earlier.parent = out.before.parent.data(), earlier.bar = out.before.bar.data();
  earlier.achieved_start = out.bars_before.achieved_start.data();
  earlier.achieved_end = out.bars_before.achieved_end.data();
  conceg::Phases phases;
  out.after.summary = conceg::grow::grow(state, threads, nullptr, phases);
  out.after.skeleton = deliver_skeleton(state), out.after.bars = deliver_bars(state);
  state.input.earlier = {};
  return out;
}

std::size_t count(const BarReport &bars, std::uint8_t state) {
  return static_cast<std::size_t>(std::count(bars.state.begin(), bars.state.end(), state));
}

double cable(const BarReport &bars) {
  double sum = 0.0;
  for (std::size_t b = 0; b < bars.state.size(); b++)
    sum += bars.achieved_end[b] - bars.achieved_start[b];
  return sum;
}

void goes_on() {
  const World world = crowded();
  const Second s = finish(world, hasty(), 1, 0.1);
  printf("bars done %zu, short %zu, lost %zu; then %zu, %zu, %zu; cable %.1f -> %.1f um\n",
         count(s.bars_before, bar_done), count(s.bars_before, bar_short), count(s.bars_before, bar_lost),
         count(s.after.bars, bar_done), count(s.after.bars, bar_short), count(s.after.bars, bar_lost),
         cable(s.bars_before), cable(s.after.bars));
  CHECK(count(s.bars_before, bar_short) > 3 && count(s.bars_before, bar_lost) > 3);
  CHECK(count(s.after.bars, bar_short) < count(s.bars_before, bar_short));
  CHECK(count(s.after.bars, bar_lost) < count(s.bars_before, bar_lost));
  CHECK(cable(s.after.bars) > 1.05 * cable(s.bars_before));
  for (std::size_t b = 0; b < s.bars_before.state.size(); b++) {
    if (s.bars_before.state[b] != bar_done) continue;
    CHECK_EQUAL(s.after.bars.state[b], bar_done);
    CHECK_NEAR(s.after.bars.achieved_end[b], s.bars_before.achieved_end[b], 1e-9);
  }
}

// Every old point stands where it was, with its target radius, its parent, its bar and its tree.
void old_points_stay() {
  const World world = crowded();
  const Second s = finish(world, hasty(), 1, 0.1);
  const Skeleton &old = s.before, &now = s.after.skeleton;
  CHECK(now.position.size() > old.position.size());
  std::size_t missing = 0;
  for (std::size_t c = 0; c < world.cell_id.size(); c++) {
    std::map<std::vector<double>, std::size_t> at;
    const auto key = [](const glm::dvec3 &p) { return std::vector<double>{p.x, p.y, p.z}; };
    for (std::size_t i = now.cell_offset[c]; i < now.cell_offset[c + 1]; i++)
      at[key(now.position[i])] = i;
    for (std::size_t i = old.cell_offset[c]; i < old.cell_offset[c + 1]; i++) {
      const auto found = at.find(key(old.position[i]));
      missing += found == at.end();
      if (found == at.end()) continue;
      const std::size_t j = found->second;
      CHECK(now.target_radius[j] == old.target_radius[i] && now.bar[j] == old.bar[i] &&
            now.tree[j] == old.tree[i]);
      CHECK_EQUAL(now.parent[j] < 0, old.parent[i] < 0);
      if (old.parent[i] < 0) continue;
      const auto parent = [&](const Skeleton &skeleton, std::size_t k) {
        return key(skeleton.position[skeleton.cell_offset[c] + static_cast<std::size_t>(skeleton.parent[k])]);
      };
      CHECK(parent(now, j) == parent(old, i));
    }
  }
  CHECK_EQUAL(missing, 0u);
}

// New pieces keep clear of what stands.
void nothing_new_overlaps() {
  const World world = crowded();
  const Second s = finish(world, hasty(), 1, 0.0);
  CHECK_EQUAL(s.deepest_before, 0.0);
  CHECK(deepest_overlap(world, s.after.skeleton) < 1e-5);
}

void same_bytes_for_any_threads() {
  const World world = crowded();
  const Second one = finish(world, hasty(), 1, 0.1), three = finish(world, hasty(), 3, 0.1);
  CHECK(same_bytes(one.after.skeleton.position, three.after.skeleton.position));
  CHECK(same_bytes(one.after.skeleton.radius, three.after.skeleton.radius));
  CHECK(same_bytes(one.after.bars.achieved_end, three.after.bars.achieved_end));
}

} // namespace

int main() {
  goes_on();
  old_points_stay();
  nothing_new_overlaps();
  same_bytes_for_any_threads();
  return check_done();
}
