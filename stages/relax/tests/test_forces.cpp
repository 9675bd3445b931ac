// SPDX-License-Identifier: BSD-3-Clause
// Forces and motion: known geometry, volume weights, no drift, pinned roots, equal bytes for any number of
// threads.
#include "../relax.hpp"
#include "../spheres.hpp"
#include "check.h"
#include "scene.hpp"

#include <cstring>

using namespace conceg;
using namespace conceg::relax;

namespace {

std::vector<glm::dvec3> pair_forces(const Bodies &bodies, const conceg_box &box, const Strength &strength,
                                    unsigned threads = 1) {
  Workers workers(threads);
  PairForces forces;
  forces.set_pairs(bodies, scene::find(bodies, box, 0.5, threads));
  std::vector<glm::dvec3> out(bodies.points, glm::dvec3(0));
  forces.add(bodies, strength, side(box), workers, out);
  return out;
}

Skeletons crossing(double offset, float first, float second) {
  Skeletons s;
  scene::add_cable(s, {10, 20, 20}, {0.5, 0, 0}, 41, first);
  scene::add_cable(s, {20, 10, 20 + offset}, {0, 0.5, 0}, 41, second);
  return s;
}

void volumes_8_to_1() {
  // Radii 2 : 1, so volumes 8 : 1: of a push the thick one takes 1/9, the thin one 8/9.
  const Bodies bodies = make_bodies(crossing(0.7, 0.6f, 0.3f), 0.1);
  Strength strength;
  strength.attraction = 0;
  const std::vector<glm::dvec3> force = pair_forces(bodies, scene::box_of(40), strength);
  glm::dvec3 thick(0), thin(0);
  for (std::size_t i = 0; i < 41; i++)
    thick += force[i], thin += force[41 + i];
  CHECK(thick.z < 0 && thin.z > 0);
  CHECK_NEAR(-thin.z / thick.z, 8, 1e-5);
  CHECK_NEAR(8 * thick.z + thin.z, 0, 1e-6); // momentum
}

void no_drift() {
  // Equal radii, so equal volumes: what one body gets the other loses. Pairs with a (pinned) root are left
  // out.
  Skeletons s = scene::random_cells(11, 5, 240, 14, 0, 0.4f);
  for (float &r : s.target_radius)
    r = 0.4f;
  const Bodies bodies = make_bodies(s, 0.1);
  std::vector<Pair> pairs;
  for (const Pair &p : scene::find(bodies, scene::box_of(14), 0.5)) {
    const auto inner = [&](std::uint32_t e) {
      return bodies.parent[e] >= 0 && bodies.parent[static_cast<std::size_t>(bodies.parent[e])] >= 0;
    };
    if (inner(p.e) && inner(p.f)) pairs.push_back(p);
  }
  CHECK(pairs.size() > 100);
  Workers workers(1);
  PairForces forces;
  forces.set_pairs(bodies, pairs);
  std::vector<glm::dvec3> force(bodies.points, glm::dvec3(0));
  forces.add(bodies, Strength(), glm::dvec3(14), workers, force);
  glm::dvec3 sum(0);
  double size = 0;
  for (const glm::dvec3 &f : force)
    sum += f, size += glm::length(f);
  CHECK(size > 1);
  CHECK(glm::length(sum) < 1e-10 * size);
  std::vector<glm::dvec3> shape(bodies.points, glm::dvec3(0));
  add_shape_forces(bodies, Strength(), workers, shape);
  for (const glm::dvec3 &f : shape)
    CHECK(glm::length(f) < 1e-12); // at rest at the start
}

void crossing_cables_separate() {
  Bodies bodies = make_bodies(crossing(0.1, 0.5f, 0.5f), 0.1);
  const Bodies before = bodies;
  const conceg_box box = scene::box_of(40);
  Workers workers(2);
  Collider collider(2);
  Motion motion;
  const Moved moved = move_bodies(bodies, box, Strength(), motion, collider, workers, {});
  const Certificate after =
      certify(bodies, scene::find(bodies, box, 0.2), side(box), 0.04, bodies.radius, workers);
  printf("crossing cables: smallest gap %.4f um after %d iterations, cable %.3f -> %.3f um\n",
         after.smallest_gap, motion.iterations, moved.length_before, moved.length_after);
  CHECK(certify(before, scene::find(before, box, 0.2), side(box), 0.04, before.radius, workers).smallest_gap <
        -0.85);
  CHECK(after.smallest_gap > 0);
  CHECK_NEAR(moved.length_after / moved.length_before, 1, 0.03);
  CHECK(moved.rebuilds >= 1 && moved.rebuilds < 80);
  CHECK(bodies.position[0] == before.position[0] &&
        bodies.position[41] == before.position[41]); // pinned roots
  CHECK(bodies.parent == before.parent);
}

void open_box_keeps_points() {
  Skeletons s;
  scene::add_cable(s, {1, 5, 0.3}, {0.5, 0, 0}, 17, 0.5f);
  scene::add_cable(s, {5, 1, 0.5}, {0, 0.5, 0}, 17, 0.5f);
  Bodies bodies = make_bodies(s, 0.1);
  const conceg_box box = scene::box_of(10, false);
  Workers workers(1);
  Collider collider(1);
  move_bodies(bodies, box, Strength(), Motion(), collider, workers, {});
  for (const glm::dvec3 &p : bodies.position)
    for (int a = 0; a < 3; a++)
      CHECK(p[a] >= 0 && p[a] <= 10);
}

void same_bytes() {
  const conceg_box box = scene::box_of(14);
  std::vector<glm::dvec3> first;
  for (unsigned threads = 1; threads <= 3; threads++) {
    Bodies bodies = make_bodies(scene::random_cells(5, 4, 600, 14, 2.0f, 0.35f), 0.1);
    Workers workers(threads);
    Collider collider(threads);
    Motion motion;
    motion.iterations = 25;
    move_bodies(bodies, box, Strength(), motion, collider, workers, {});
    if (threads == 1) first = bodies.position;
    CHECK(!memcmp(first.data(), bodies.position.data(), first.size() * sizeof first[0]));
  }
}

void cancels() {
  Bodies bodies = make_bodies(crossing(0.1, 0.5f, 0.5f), 0.1);
  Workers workers(1);
  Collider collider(1);
  bool stopped = false;
  try {
    move_bodies(bodies, scene::box_of(40), Strength(), Motion(), collider, workers,
                [](const char *, std::uint64_t done, std::uint64_t) { return done < 3; });
  } catch (const Error &error) {
    stopped = error.status() == CONCEG_E_CANCELLED;
  }
  CHECK(stopped);
}

void spheres_overlap() {
  const Skeletons s = scene::random_cells(2, 3, 100, 12, 2.0f, 0.4f);
  const Spheres spheres = resample(s, 1.0);
  CHECK_EQUAL(spheres.cell_offset.size(), 4);
  CHECK_EQUAL(spheres.cell_offset.back(), spheres.center.size());
  CHECK_EQUAL(spheres.segment_end[0], -1);
  std::size_t joined = 0;
  for (std::size_t i = 1; i < spheres.center.size(); i++) {
    if (spheres.segment_end[i] < 0 || spheres.segment_end[i] != spheres.segment_end[i - 1]) continue;
    joined++;
    CHECK(glm::distance(spheres.center[i], spheres.center[i - 1]) <=
          static_cast<double>(std::min(spheres.radius[i], spheres.radius[i - 1])) * (1 + 1e-5));
  }
  CHECK(joined > 100);
  bool refused = false;
  try {
    resample(s, 0);
  } catch (const Error &) {
    refused = true;
  }
  CHECK(refused);
}

} // namespace

int main() {
  volumes_8_to_1();
  no_drift();
  crossing_cables_separate();
  open_box_keeps_points();
  same_bytes();
  cancels();
  spheres_overlap();
  return check_done();
}
