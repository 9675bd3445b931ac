// SPDX-License-Identifier: BSD-3-Clause
// Cells without a soma (passing axons): where they start, how much of the cable that was asked grows, that
// they cross nothing, run on through periodic sides, and give the same bytes for any number of threads.
#include "check.h"
#include "world.hpp"

using namespace conceg::grow;

namespace {

struct Axon {
  glm::dvec3 start, direction;
  double length;
};

// Even, isotropic axons that cross the box once.
std::vector<Axon> add_axons(World &world, double density) {
  const double side = world.box.hi[0];
  std::vector<Axon> axons;
  for (std::uint64_t i = 0; static_cast<double>(i) < density * side * side; i++) {
    conceg_rng rng = conceg_rng_stream(5, "test.axons", i);
    Axon axon{{}, {}, side};
    for (int a = 0; a < 3; a++)
      axon.start[a] = side * conceg_rng_uniform(&rng), axon.direction[a] = conceg_rng_normal(&rng);
    axon.direction = glm::normalize(axon.direction);
    world.add_cell(axon.start, 0.0);
    world.add_bar(0, -1, 0, axon.length, axon.start + axon.length * axon.direction,
                  0.25 + 0.2 * conceg_rng_uniform(&rng));
    axons.push_back(axon);
  }
  return axons;
}

// The first point is the free node nearest to the place that was asked, and the first piece heads for the
// end.
void check_starts(const Skeleton &skeleton, const std::vector<Axon> &axons) {
  double farthest = 0.0, along = 0.0;
  for (std::size_t i = 0; i < axons.size(); i++) {
    const std::size_t first = skeleton.cell_offset[i];
    if (first == skeleton.cell_offset[i + 1]) continue;
    farthest = std::max(farthest, glm::distance(skeleton.position[first], axons[i].start));
    along += glm::dot(glm::normalize(skeleton.position[first + 1] - skeleton.position[first]),
                      axons[i].direction) /
             static_cast<double>(axons.size());
  }
  printf("starts at most %.2f um off, first pieces' mean cosine %.3f\n", farthest, along);
  CHECK(farthest < 2.5);
  CHECK(along > 0.85);
}

void empty_box() {
  for (const double density : {0.35, 1.0}) {
    World world;
    world.make_box(20, true);
    const std::vector<Axon> axons = add_axons(world, density);
    world.make_network(0.8, 0.2, 1.0);
    const Grown grown = grow_world(world), again = grow_world(world, {}, 3);
    const FreeCable cable = measure_free_cable(grown.state, grown.bars);
    const double box = 20.0 * 20.0 * 20.0;
    printf("asked %.4f um per um3, grown %.4f; %llu short, %llu lost\n", cable.asked_um / box,
           cable.grown_um / box, static_cast<unsigned long long>(cable.cut_short),
           static_cast<unsigned long long>(cable.lost));
    CHECK_EQUAL(cable.cells, axons.size());
    CHECK_NEAR(cable.asked_um / box, density, 1e-9);
    CHECK_NEAR(cable.grown_um / cable.asked_um, 1.0, 0.03);
    CHECK_NEAR(measure(grown.state, grown.skeleton).cable_um, cable.grown_um, 1e-6 * cable.grown_um);
    CHECK_NEAR(deepest_overlap(world, grown.skeleton), 0.0, 0.0);
    CHECK(same_bytes(grown.skeleton.position, again.skeleton.position));
    CHECK(same_bytes(grown.skeleton.radius, again.skeleton.radius));
    check_starts(grown.skeleton, axons);
    double farthest = 0.0;
    for (const glm::dvec3 &place : grown.skeleton.position)
      for (int a = 0; a < 3; a++)
        farthest = std::max(farthest, std::max(place[a] - 20.0, -place[a]));
    CHECK(farthest > 10.0); // unwrapped: through the face and on
    // Planted: an axon laid onto another is found.
    Skeleton moved = grown.skeleton;
    moved.position[moved.cell_offset[1]] = moved.position[0];
    CHECK(deepest_overlap(world, moved) > 0.1);
  }
}

// Without a free node around the place that was asked, nothing grows and it is counted.
void no_start() {
  World world;
  world.make_box(24, true);
  world.add_cell({12, 12, 12}, 8.0);
  world.add_cell({12, 12, 13}, 0.0); // far within the soma
  world.add_bar(0, -1, 0, 20, {12, 12, 33}, 0.3);
  world.add_cell({2, 2, 2}, 0.0);
  world.add_bar(0, -1, 0, 20, {2, 2, 22}, 0.3);
  world.make_network(1.0, 0.2, 1.25);
  const Grown grown = grow_world(world);
  const FreeCable cable = measure_free_cable(grown.state, grown.bars);
  CHECK_EQUAL(cable.cells, 2);
  CHECK_EQUAL(cable.lost, 1);
  CHECK_EQUAL(grown.bars.state[0], bar_lost);
  CHECK_EQUAL(grown.bars.state[1], bar_done);
  CHECK_NEAR(cable.grown_um, 20.0, 1e-3);
  CHECK_EQUAL(grown.skeleton.cell_offset[1], grown.skeleton.cell_offset[2]); // an empty cell
}

// Both want the same node: the cell of the lower row has it, the other the next free one.
void shared_start() {
  World world;
  world.make_box(20, true);
  for (int i = 0; i < 2; i++) {
    world.add_cell({10, 10, 10}, 0.0);
    world.add_bar(0, -1, 0, 15, {10.0 + 15.0 * i, 10, 25.0 - 15.0 * i}, 0.4);
  }
  world.make_network(1.0, 0.2, 1.25);
  const Grown grown = grow_world(world);
  const Skeleton &s = grown.skeleton;
  double nearest = 1e9;
  for (std::size_t i = 0; i < world.node.size() / 3; i++)
    nearest =
        std::min(nearest, glm::distance({world.node[3 * i], world.node[3 * i + 1], world.node[3 * i + 2]},
                                        glm::dvec3(10, 10, 10)));
  CHECK_NEAR(glm::distance(s.position[0], {10, 10, 10}), nearest, 1e-12);
  CHECK(glm::distance(s.position[s.cell_offset[1]], {10, 10, 10}) > nearest);
  CHECK_EQUAL(grown.summary.done, 2);
  CHECK_NEAR(deepest_overlap(world, s), 0.0, 0.0);
}

// Cells with a soma grow first, as if there were no axons; those fill what room is left, and cross nothing.
void cells_come_first() {
  World alone;
  alone.make_box(24, true);
  for (int c = 0; c < 2; c++) {
    alone.add_cell({6.0 + 12.0 * c, 12, 12}, 2.5);
    alone.add_random_trees(10, 10, 100, 0.8, 90 + static_cast<unsigned>(c));
  }
  World both = alone;
  add_axons(both, 1.0);
  alone.make_network(0.8, 0.2, 1.0), both.make_network(0.8, 0.2, 1.0);
  const Grown without = grow_world(alone), with = grow_world(both), again = grow_world(both, {}, 3);
  const std::size_t points = without.skeleton.position.size();
  CHECK_EQUAL(with.skeleton.cell_offset[2], points);
  CHECK(std::equal(without.skeleton.position.begin(), without.skeleton.position.end(),
                   with.skeleton.position.begin()));
  const FreeCable cable = measure_free_cable(with.state, with.bars);
  printf("beside cells: asked %.4f um per um3, grown %.4f; %llu short, %llu lost\n",
         cable.asked_um / (24.0 * 24.0 * 24.0), cable.grown_um / (24.0 * 24.0 * 24.0),
         static_cast<unsigned long long>(cable.cut_short), static_cast<unsigned long long>(cable.lost));
  CHECK(cable.grown_um > 0.5 * cable.asked_um && cable.grown_um < cable.asked_um);
  CHECK_NEAR(deepest_overlap(both, with.skeleton), 0.0, 0.0);
  CHECK(same_bytes(with.skeleton.position, again.skeleton.position));
  CHECK(same_bytes(with.bars.state, again.bars.state));
}

// In a small box with many axons a round offers steps of some of them alone, so that few are put off.
void crowded_rounds() {
  World world;
  world.make_box(20, true);
  add_axons(world, 1.0);
  world.make_network(0.8, 0.2, 1.0);
  const Grown grown = grow_world(world);
  printf("%llu steps in %llu rounds, %llu deferred\n", static_cast<unsigned long long>(grown.summary.steps),
         static_cast<unsigned long long>(grown.summary.rounds),
         static_cast<unsigned long long>(grown.summary.deferred));
  CHECK(grown.summary.deferred < grown.summary.steps);
  CHECK(grown.summary.steps <= 16 * grown.summary.rounds);
}

} // namespace

int main() {
  cells_come_first();
  crowded_rounds();
  empty_box();
  no_start();
  shared_start();
  return check_done();
}
