// SPDX-License-Identifier: BSD-3-Clause
// Rounds: the same bytes for any number of threads, another tissue for another seed, work for every worker.
#include "check.h"
#include "step.hpp"
#include "team.hpp"
#include "world.hpp"

using namespace conceg::grow;

namespace {

bool same(const Grown &a, const Grown &b) {
  const Skeleton &x = a.skeleton, &y = b.skeleton;
  return same_bytes(x.position, y.position) && same_bytes(x.radius, y.radius) &&
         same_bytes(x.target_radius, y.target_radius) && same_bytes(x.parent, y.parent) &&
         same_bytes(x.branch, y.branch) && same_bytes(x.bar, y.bar) && same_bytes(x.status, y.status) &&
         same_bytes(a.bars.achieved_start, b.bars.achieved_start) &&
         same_bytes(a.bars.achieved_end, b.bars.achieved_end) && same_bytes(a.bars.state, b.bars.state) &&
         same_bytes(a.bars.handed_to, b.bars.handed_to) &&
         same_bytes(a.state.space.sites, b.state.space.sites);
}

World crowded(int cells) {
  World world;
  world.make_box(22, true);
  for (int c = 0; c < cells; c++) {
    world.add_cell({5.0 + 11.0 * (c & 1), 5.0 + 11.0 * (c >> 1), 5.0 + 11.0 * ((c * 3) % 4 & 1)}, 3.0);
    world.add_random_trees(7, 10, 70, 0.7, 20 + static_cast<unsigned>(c));
  }
  world.make_network(1.0, 0.2, 1.25);
  return world;
}

void threads() {
  const World world = crowded(4);
  const Grown one = grow_world(world, {}, 1), two = grow_world(world, {}, 2),
              three = grow_world(world, {}, 3);
  CHECK(one.summary.collapses > 0 && one.summary.deferred > 0);
  CHECK(same(one, two));
  CHECK(same(one, three));
  CHECK(!same(one, grow_world(world, {}, 2, 2))); // another seed
  CHECK_EQUAL(two.summary.steps_by_worker.size(), 2);
  for (const std::uint64_t steps : two.summary.steps_by_worker)
    CHECK(5 * steps > two.summary.steps);
  for (const std::uint64_t steps : three.summary.steps_by_worker)
    CHECK(5 * steps > three.summary.steps);
}

void threads_with_calibre_and_course() {
  World world = crowded(4);
  world.calibre.assign(world.tree.size(), {0.25, 4.0});
  const Grown waves = grow_world(world, {}, 1);
  world.straightness = 0.8;
  const Grown one = grow_world(world, {}, 1);
  CHECK(same(one, grow_world(world, {}, 2)));
  CHECK(same(one, grow_world(world, {}, 3)));
  CHECK(!same(one, waves)); // the course is there, and so is the calibre
  CHECK(!same(waves, grow_world(crowded(4), {}, 1)));
}

// A round equals its accepted steps one after another: each is proposed again on what those before it left.
bool same_state(const State &a, const State &b) {
  bool equal = same_bytes(a.space.sites, b.space.sites);
  for (std::size_t bar = 0; equal && bar < a.projections.size(); bar++) {
    const Projection &p = a.projections[bar], &q = b.projections[bar];
    equal = p.chain.size() == q.chain.size() && p.settled == q.settled && p.attractor == q.attractor;
    for (std::size_t i = 0; equal && i < p.chain.size(); i++)
      equal = p.chain[i].position == q.chain[i].position && p.chain[i].path == q.chain[i].path &&
              p.chain[i].radius == q.chain[i].radius && p.chain[i].node == q.chain[i].node;
  }
  return equal;
}

void replay(State &state, const std::vector<std::uint32_t> &bars) {
  for (const std::uint32_t bar : bars) {
    Edit edit;
    propose(state, bar, edit);
    number_segments(state.space, edit);
    commit(state, edit);
    return_segments(state.space, edit);
  }
}

void serial(const Parameters &parameters) {
  World world = crowded(4);
  world.calibre.assign(world.tree.size(), {0.25, 4.0});
  world.straightness = 0.8;
  State state, forward, backward, unchanged;
  state.input = world.input(), state.parameters = parameters;
  std::size_t rounds = 0, compared = 0, steps = 0, equal_forward = 0, equal_backward = 0, moved = 0;
  Watch watch;
  watch.before = [&](const State &frozen, const std::vector<std::uint32_t> &bars) {
    if (rounds++ % 5 != 0) return;
    forward = frozen, backward = frozen, unchanged = frozen;
    replay(forward, bars);
    replay(backward, {bars.rbegin(), bars.rend()});
    steps += bars.size();
  };
  watch.after = [&](const State &committed) {
    if (rounds % 5 != 1) return;
    compared++;
    equal_forward += same_state(forward, committed), equal_backward += same_state(backward, committed);
    moved += !same_state(unchanged, committed); // the comparison can fail
  };
  conceg::Phases phases;
  conceg::grow::grow(state, 2, nullptr, phases, watch);
  printf("%zu rounds of %.1f steps replayed\n", compared,
         static_cast<double>(steps) / static_cast<double>(compared));
  CHECK(compared > 50 && steps > 3 * compared);
  CHECK_EQUAL(equal_forward, compared);
  CHECK_EQUAL(equal_backward, compared);
  CHECK_EQUAL(moved, compared);
}

// One cell alone still gives every worker its share.
void one_cell() {
  const World world = crowded(1);
  const Grown two = grow_world(world, {}, 2);
  for (const std::uint64_t steps : two.summary.steps_by_worker)
    CHECK(5 * steps > two.summary.steps);
}

void team() {
  conceg::Team workers(3);
  std::vector<int> done(1000, 0);
  for (int round = 0; round < 200; round++)
    workers.loop(done.size(), [&](std::size_t i, unsigned) { done[i]++; });
  bool all = true;
  for (const int times : done)
    all &= times == 200;
  CHECK(all);
  bool thrown = false;
  try {
    workers.loop(10, [](std::size_t i, unsigned) {
      if (i == 4) throw 5;
    });
  } catch (const int value) {
    thrown = value == 5;
  }
  CHECK(thrown);
  workers.loop(10, [&](std::size_t i, unsigned) { done[i] = 0; });
  CHECK_EQUAL(done[9], 0);
}

} // namespace

int main() {
  team();
  threads();
  threads_with_calibre_and_course();
  one_cell();
  serial({});
  Parameters paper;
  paper.occupancy = Occupancy::nodes, paper.smoothing = 0.0, paper.radius_fraction = 1.0;
  serial(paper);
  return check_done();
}
