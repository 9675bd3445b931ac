// SPDX-License-Identifier: BSD-3-Clause
// Rounds: the same bytes for any number of threads, another tissue for another seed, work for every worker.
#include "check.h"
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
         same_bytes(a.state.space.field, b.state.space.field);
}

World crowded(int cells) {
  World world;
  world.make_box(22, true);
  for (int c = 0; c < cells; c++) {
    world.add_cell({5.0 + 11.0 * (c & 1), 5.0 + 11.0 * (c >> 1), 5.0 + 11.0 * ((c * 3) % 4 & 1)}, 3.0);
    world.add_random_trees(6, 10, 70, 0.6, 20 + static_cast<unsigned>(c));
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
  return check_done();
}
