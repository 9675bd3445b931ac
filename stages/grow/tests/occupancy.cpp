// SPDX-License-Identifier: BSD-3-Clause
// Occupancy: distances, clearances by hand, and a field that grows back exactly.
#include "check.h"
#include "world.hpp"

using namespace conceg::grow;

namespace {

void distances() {
  conceg_rng rng = conceg_rng_stream(5, "test.distances", 1);
  const auto point = [&] {
    return glm::dvec3{conceg_rng_uniform(&rng), conceg_rng_uniform(&rng), conceg_rng_uniform(&rng)} * 4.0 -
           2.0;
  };
  for (int trial = 0; trial < 200; trial++) {
    const glm::dvec3 between = point(), h1 = 0.5 * point(), h2 = trial % 7 ? 0.5 * point() : h1 * 1.5;
    const double got = segment_segment_distance(between, h1, h2);
    double least = 1e9;
    for (int i = -40; i <= 40; i++)
      for (int j = -40; j <= 40; j++)
        least = std::min(least, glm::distance(between + h1 * (i / 40.0), h2 * (j / 40.0)));
    CHECK(got <= least + 1e-12);
    CHECK(got >= least - 0.06);
  }
  CHECK_NEAR(segment_segment_distance({0, 3, 0}, {1, 0, 0}, {0, 0, 1}), 3.0, 1e-15);
  CHECK_NEAR(segment_segment_distance({3, 0, 0}, {1, 0, 0}, {0.5, 0, 0}), 1.5, 1e-15);
  CHECK_NEAR(segment_segment_distance({0, 2, 0}, {0, 0, 0}, {0, 0, 0}), 2.0, 1e-15);
  CHECK_NEAR(point_segment_distance({3, 4, 0}, {0, 0, 0}, {0, 0, 1}), 5.0, 1e-15);
}

State empty_state(World &world) {
  world.make_box(12, true);
  world.add_cell({6, 6, 6}, 0.0);
  world.add_bar(0, -1, 0, 50, {20, 6, 6}, 0.8);
  world.add_bar(0, 0, 20, 40, {20, 6, 6}, 0.8);
  world.add_cell({2, 2, 2}, 1.0);
  world.add_bar(0, -1, 0, 20, {20, 2, 2}, 0.8);
  world.make_network(1.0, 0.1, 1.2);
  State state;
  state.input = world.input();
  state.projections.resize(3);
  state.projections[1].host = 0, state.projections[1].start_path = 20.0;
  state.projections[2].cell = 1;
  make_space(state);
  return state;
}

std::uint32_t add(State &state, const glm::dvec3 &a, const glm::dvec3 &b, double r, std::uint32_t cell,
                  std::uint32_t bar, double path) {
  state.space.segments.push_back(make_segment(state.input.box, a, b, r, cell, bar, path));
  const auto id = static_cast<std::uint32_t>(state.space.segments.size() - 1);
  insert_capsule(state.space, id);
  return id;
}

void clearances() {
  World world;
  State state = empty_state(world);
  const auto probe = [&](const glm::dvec3 &a, const glm::dvec3 &b, std::uint32_t cell, std::uint32_t bar,
                         double path) {
    return clearance(state, make_segment(state.input.box, a, b, 0.4, cell, bar, path), 0.4, 0.15);
  };
  CHECK_NEAR(probe({8, 8, 8}, {9, 8, 8}, 0, 0, 10), 0.4, 0.0);
  // A soma of 1 um at 1.3 um: 0.3 um is left; at 1.1 um nothing.
  CHECK_NEAR(probe({2, 2, 3.3}, {2, 3, 3.3}, 0, 0, 10), 0.3, 1e-5);
  CHECK(probe({2, 2, 3.1}, {2, 3, 3.1}, 0, 0, 10) < 0.0);
  // The same seen through the periodic face, from an unwrapped place.
  CHECK_NEAR(probe({14, 2, 15.3}, {14, 3, 15.3}, 0, 0, 10), 0.3, 1e-5);
  // A capsule of another cell, crossing at 0.5 um with 0.2 um radius.
  add(state, {8, 8, 8.5}, {8, 9, 8.5}, 0.2, 1, 2, 5.0);
  CHECK_NEAR(probe({7.5, 8.5, 8}, {8.5, 8.5, 8}, 0, 0, 10), 0.3, 1e-5);
  // Its own cell: near along the tree nothing counts, far along it does, and its own image always does.
  CHECK_NEAR(probe({7.5, 8.5, 8}, {8.5, 8.5, 8}, 1, 2, 5.5), 0.4, 0.0);
  CHECK_NEAR(probe({7.5, 8.5, 8}, {8.5, 8.5, 8}, 1, 2, 15), 0.3, 1e-5);
  CHECK_NEAR(probe({19.5, 8.5, 8}, {20.5, 8.5, 8}, 1, 2, 5.5), 0.3, 1e-5);
}

void trees() {
  World world;
  const State state = empty_state(world);
  CHECK_NEAR(tree_distance(state, 0, 12, 0, 15, 100), 3.0, 1e-12);
  CHECK_NEAR(tree_distance(state, 1, 24, 0, 15, 100), 9.0, 1e-12);
  CHECK_NEAR(tree_distance(state, 0, 26, 1, 21, 100), 7.0, 1e-12);
}

bool field_is_fresh(const State &state) {
  for (std::uint32_t node = 0; node < state.input.network.nodes; node++) {
    const NodeField fresh = fresh_field(state.input, state.space, node);
    if (std::memcmp(&fresh, &state.space.site(node).field, sizeof fresh) != 0) return false;
  }
  return true;
}

void grows_back() {
  World world;
  State state = empty_state(world);
  const std::vector<Site> before = state.space.sites;
  std::vector<std::uint32_t> ids;
  for (int i = 0; i < 3; i++)
    for (const std::uint32_t cell : {0u, 1u})
      ids.push_back(add(state, {11.0 + i, 7.9, 8.0 + 0.9 * cell}, {12.0 + i, 7.9, 8.0 + 0.9 * cell}, 0.3,
                        cell, cell ? 2 : 0, 5.0 + i));
  for (const std::uint32_t id : ids) {
    state.space.segments[id].in_field = 1;
    lower_field(state.input, state.space, id);
  }
  CHECK(field_is_fresh(state));
  CHECK(std::memcmp(before.data(), state.space.sites.data(), before.size() * sizeof before[0]) != 0);
  std::vector<Segment> removed;
  for (const std::uint32_t id : ids) {
    removed.push_back(state.space.segments[id]);
    remove_capsule(state.space, id);
  }
  CHECK(!field_is_fresh(state)); // planted: taken out, not yet given back
  restore_field(state.input, state.space, removed);
  CHECK(field_is_fresh(state));
  CHECK(std::memcmp(before.data(), state.space.sites.data(), before.size() * sizeof before[0]) == 0);
}

// A crowded box with many collapses: at the end the field is that of what stands.
void after_collapses() {
  World world;
  world.make_box(16, true);
  for (int c = 0; c < 4; c++) {
    world.add_cell({4.0 + 8.0 * (c & 1), 4.0 + 8.0 * (c >> 1), 4.0 + 8.0 * ((c * 3) % 4 & 1)}, 2.0);
    world.add_random_trees(8, 8, 60, 0.6, 50 + static_cast<unsigned>(c));
  }
  world.make_network(1.0, 0.2, 1.25);
  const Grown grown = grow_world(world);
  CHECK(grown.summary.collapses > 20);
  CHECK(field_is_fresh(grown.state));
  std::size_t alive = 0, marked = 0, used = 0;
  for (const Segment &segment : grown.state.space.segments)
    alive += segment.alive && segment.bar != none;
  for (const Projection &projection : grown.state.projections)
    if (projection.chain.size() > 1) used += projection.chain.size() - 1;
  for (const Site &site : grown.state.space.sites)
    marked += site.user != none;
  CHECK_EQUAL(alive, used);
  CHECK(marked <= used && marked > used / 2);
}

} // namespace

int main() {
  distances();
  clearances();
  trees();
  grows_back();
  after_collapses();
  return check_done();
}
