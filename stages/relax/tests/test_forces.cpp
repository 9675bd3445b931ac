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

// The forces between bodies as the motion has them.
std::vector<glm::dvec3> contact_forces(const Bodies &bodies, const conceg_box &box, const Strength &strength,
                                       unsigned threads = 1, State *state = nullptr) {
  Workers workers(threads);
  Collider collider(threads);
  const ChunkSearch found = collider.find_chunks(bodies, bodies.radius, box, 0.5, workers);
  LaneBodies lanes;
  lanes.fill(bodies, found.lift, box, workers);
  Runs close;
  prune_runs(bodies, make_runs(bodies, found, lanes, box, 0.5, workers), lanes, 0.45, workers, close);
  std::vector<glm::dvec3> out(bodies.points, glm::dvec3(0));
  State unused;
  ContactForces().add(bodies, lanes, close, strength, workers, out, state ? *state : unused);
  return out;
}

// The same, pair by pair in double: equation (1) of the README.
std::vector<glm::dvec3> plain_forces(const Bodies &bodies, const conceg_box &box, const Strength &k,
                                     State &state) {
  std::vector<glm::dvec3> out(bodies.position.size(), glm::dvec3(0));
  for (const Pair &pair : scene::find(bodies, box, 0.5)) {
    RoundCone first, second;
    cones_of(bodies, pair, bodies.radius, side(box), first, second);
    const Closest at = closest_axes(first, second);
    const Element &e = bodies.elements[pair.e], &f = bodies.elements[pair.f];
    const bool one_body = same_copy(pair) && e.cell == f.cell;
    const double x = at.gap - k.gap;
    double size = 0;
    if (x < 0) size = -k.repulsion * x;
    if (x >= 0 && x < k.attraction_range && !one_body)
      size = -k.attraction * x * (1 - x / k.attraction_range);
    if (at.gap < 0) state.overlapping++, state.overlap_sum -= at.gap;
    state.largest_overlap = std::max(state.largest_overlap, -at.gap);
    if (size == 0) continue;
    const glm::dvec3 push = size * glm::normalize(first.a + at.s * (first.b - first.a) -
                                                  (second.a + at.t * (second.b - second.a)));
    const double r = first.radius_a + at.s * (first.radius_b - first.radius_a),
                 q = second.radius_a + at.t * (second.radius_b - second.radius_a);
    const bool pinned_e = bodies.pinned[e.a] && bodies.pinned[e.b],
               pinned_f = bodies.pinned[f.a] && bodies.pinned[f.b];
    const double share = std::min(0.85, std::max(0.15, q * q * q / (r * r * r + q * q * q)));
    const glm::dvec3 on_e = (pinned_f ? 3 : share) * push, on_f = -(pinned_e ? 3 : 1 - share) * push;
    out[e.a] += (1 - at.s) * on_e, out[e.b] += at.s * on_e;
    out[f.a] += (1 - at.t) * on_f, out[f.b] += at.t * on_f;
  }
  out.resize(bodies.points);
  for (std::size_t i = 0; i < bodies.points; i++)
    if (bodies.pinned[i]) out[i] = glm::dvec3(0);
  return out;
}

void four_at_a_time_is_pair_by_pair() {
  for (const double size : {12.0, 7.0}) {
    const Bodies bodies = make_bodies(scene::random_cells(17, 4, 200, size, 1.5f, 0.4f), 0.1);
    const conceg_box box = scene::box_of(size);
    State plain, lanes;
    const std::vector<glm::dvec3> expected = plain_forces(bodies, box, Strength(), plain);
    const std::vector<glm::dvec3> found = contact_forces(bodies, box, Strength(), 2, &lanes);
    double largest = 0, difference = 0;
    for (std::size_t i = 0; i < bodies.points; i++) {
      largest = std::max(largest, glm::length(expected[i]));
      difference = std::max(difference, glm::distance(expected[i], found[i]));
    }
    printf("box %g: largest force %.3g um, largest difference %.2g; %llu and %llu pairs overlap\n", size,
           largest, difference, (unsigned long long)plain.overlapping, (unsigned long long)lanes.overlapping);
    CHECK(largest > 0.1 && difference < 1e-3 * largest);
    CHECK(plain.overlapping > 100 && plain.overlapping == lanes.overlapping);
    CHECK_NEAR(lanes.overlap_sum / plain.overlap_sum, 1, 1e-5);
    CHECK_NEAR(lanes.largest_overlap, plain.largest_overlap, 1e-5);
  }
}

Skeletons crossing(double offset, float first, float second) {
  Skeletons s;
  scene::add_cable(s, {10, 20, 20}, {0.5, 0, 0}, 41, first);
  scene::add_cable(s, {20, 10, 20 + offset}, {0, 0.5, 0}, 41, second);
  return s;
}

// How many times as far as the thick cable (radius 0.6) the thin one is pushed, where both touch.
double yielding(float thin_radius) {
  const Bodies bodies = make_bodies(crossing(0.4 + thin_radius, 0.6f, thin_radius), 0.1);
  Strength strength;
  strength.attraction = 0;
  const std::vector<glm::dvec3> force = contact_forces(bodies, scene::box_of(40), strength);
  glm::dvec3 thick(0), thin(0);
  for (std::size_t i = 0; i < 41; i++)
    thick += force[i], thin += force[41 + i];
  CHECK(thick.z < 0 && thin.z > 0);
  return -thin.z / thick.z;
}

void small_yields_to_large() {
  CHECK_NEAR(yielding(0.6f), 1, 1e-5);
  CHECK_NEAR(yielding(0.4f), 27.0 / 8, 1e-5);     // as the volumes
  CHECK_NEAR(yielding(0.15f), 0.85 / 0.15, 1e-5); // but never alone
}

void no_drift() {
  // Equal radii, so equal volumes: what one body gets the other loses. With nothing pinned, so that all
  // counts.
  Skeletons s = scene::random_cells(11, 5, 240, 14, 0, 0.4f);
  for (float &r : s.target_radius)
    r = 0.4f;
  Bodies bodies = make_bodies(s, 0.1);
  bodies.pinned.assign(bodies.pinned.size(), 0);
  const std::vector<glm::dvec3> force = contact_forces(bodies, scene::box_of(14), Strength());
  glm::dvec3 sum(0);
  double size = 0;
  for (const glm::dvec3 &f : force)
    sum += f, size += glm::length(f);
  printf("drift %.2g of %.3g\n", glm::length(sum), size);
  CHECK(size > 1);
  CHECK(glm::length(sum) < 1e-6 * size);
  std::vector<glm::dvec3> shape(bodies.points, glm::dvec3(0));
  State state;
  Workers workers(1);
  bodies = make_bodies(s, 0.1);
  add_shape_forces(bodies, bodies.rest_length, Strength(), workers, shape, state);
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
  const Moved moved =
      move_bodies(bodies, make_sections(bodies), box, Strength(), motion, collider, workers, {});
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
  move_bodies(bodies, make_sections(bodies), box, Strength(), Motion(), collider, workers, {});
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
    move_bodies(bodies, make_sections(bodies), box, Strength(), motion, collider, workers, {});
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
    move_bodies(bodies, make_sections(bodies), scene::box_of(40), Strength(), Motion(), collider, workers,
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
  four_at_a_time_is_pair_by_pair();
  small_yields_to_large();
  no_drift();
  crossing_cables_separate();
  open_box_keeps_points();
  same_bytes();
  cancels();
  spheres_overlap();
  return check_done();
}
