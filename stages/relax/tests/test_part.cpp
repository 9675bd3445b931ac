// SPDX-License-Identifier: BSD-3-Clause
// Axes that cross are pushed aside until cutting can keep the gap, and nothing else moves.
#include "../part.hpp"
#include "check.h"
#include "scene.hpp"

#include <cstring>

using namespace conceg;
using namespace conceg::relax;

namespace {

constexpr double gap = 0.04, radius_min = 0.15;

double path_of(const Bodies &bodies) {
  double sum = 0;
  for (std::size_t i = 0; i < bodies.points; i++)
    if (bodies.parent[i] >= 0)
      sum += glm::distance(bodies.position[i], bodies.position[static_cast<std::size_t>(bodies.parent[i])]);
  return sum;
}

// Two cables that go right through each other, over a face of the box, and one far from them.
void crossing_is_undone() {
  const conceg_box box = scene::box_of(20);
  Skeletons s;
  scene::add_cable(s, {-4.5, 5, 5}, {1, 0, 0}, 10, 0.4f);
  scene::add_cable(s, {20, 0.5, 5}, {0, 1, 0}, 10, 0.3f); // crosses the first one's image
  scene::add_cable(s, {5, 15, 15}, {0, 0, 1}, 10, 0.3f);
  Bodies bodies = make_bodies(s, radius_min);
  const Bodies start = bodies;
  Workers workers(1);
  Collider collider(1);
  const Parted parted = part(bodies, box, gap, collider, workers);
  CHECK_EQUAL(parted.before, 1u);
  CHECK_NEAR(parted.deepest_before, 2 * radius_min + gap, 1e-6);
  CHECK_EQUAL(parted.after, 0u);
  CHECK(parted.largest_move > 0.1 && parted.largest_move <= 0.4);
  for (std::size_t i = 20; i < 30; i++)
    CHECK(bodies.position[i] == start.position[i]);
  CHECK(bodies.position[9] == start.position[9]); // more than 3 um of path away
  CHECK(std::abs(path_of(bodies) / path_of(start) - 1) < 0.005);

  // Without parting the cut must leave the overlap, after it there is none.
  const auto overlap_of = [&](const Bodies &b) {
    std::vector<double> radius = b.radius;
    const std::vector<Pair> pairs = scene::find(b, box, gap);
    cut_radii(b, pairs, side(box), gap, b.radius, radius, workers, {});
    return certify(b, pairs, side(box), gap, radius, workers);
  };
  CHECK_NEAR(overlap_of(start).largest_overlap, 2 * radius_min, 1e-6);
  CHECK_EQUAL(overlap_of(bodies).overlapping, 0u);
  CHECK(overlap_of(bodies).smallest_gap >= gap);
}

// Roots do not move: what they are in is told.
void pinned_is_told() {
  Skeletons s;
  scene::add_cable(s, {5, 5, 5}, {1, 0, 0}, 3, 0.3f);
  scene::add_cable(s, {5, 5, 5.1}, {0, 1, 0}, 3, 0.3f);
  Bodies bodies = make_bodies(s, radius_min);
  Workers workers(1);
  Collider collider(1);
  const Parted parted = part(bodies, scene::box_of(20), gap, collider, workers);
  CHECK(parted.after > 0 && parted.deepest_after > 0.2);
  CHECK(bodies.position[0] == glm::dvec3(5, 5, 5));
}

void thicket_is_parted(unsigned threads, std::vector<glm::dvec3> &places) {
  const conceg_box box = scene::box_of(25);
  Skeletons s;
  conceg_rng rng = conceg_rng_stream(3, "test.relax.part", 0);
  for (int n = 0; n < 60; n++) {
    const glm::dvec3 from =
        25.0 * glm::dvec3{conceg_rng_uniform(&rng), conceg_rng_uniform(&rng), conceg_rng_uniform(&rng)};
    scene::add_cable(s, from, scene::direction(rng), 25, 0.25f);
  }
  Bodies bodies = make_bodies(s, radius_min);
  Workers workers(threads);
  Collider collider(threads);
  const Parted parted = part(bodies, box, gap, collider, workers);
  if (threads == 1)
    printf("thicket: %d pairs too near by up to %.3f um, then %d; largest move %.3f um\n",
           static_cast<int>(parted.before), parted.deepest_before, static_cast<int>(parted.after),
           parted.largest_move);
  CHECK(parted.before > 20);
  CHECK_EQUAL(parted.after, 0u);
  places = bodies.position;
}

} // namespace

int main() {
  crossing_is_undone();
  pinned_is_told();
  std::vector<glm::dvec3> one, three;
  thicket_is_parted(1, one);
  thicket_is_parted(3, three);
  CHECK(!memcmp(one.data(), three.data(), one.size() * sizeof one[0]));
  return check_done();
}
