// SPDX-License-Identifier: BSD-3-Clause
// The cut of the radii and its certificate.
#include "check.h"
#include "scene.hpp"

#include <cmath>
#include <cstring>

using namespace conceg;
using namespace conceg::relax;

namespace {

constexpr double gap = 0.04;

Certificate look(const Bodies &bodies, const conceg_box &box, const std::vector<double> &radius) {
  Workers workers(2);
  Collider collider(2);
  return certify(bodies, collider.find(bodies, radius, box, 0.2, workers).pairs, side(box), gap, radius,
                 workers);
}

std::vector<double> cut(const Bodies &bodies, const conceg_box &box, unsigned threads, Cut &result) {
  const std::vector<double> most = bodies.radius;
  std::vector<double> radius = most;
  Workers workers(threads);
  result =
      cut_radii(bodies, scene::find(bodies, box, gap, threads), side(box), gap, most, radius, workers, {});
  return radius;
}

void parallel_cables_share_the_room() {
  // Axes 0.9 um apart, radii 0.5: each gives up (1 - 0.9 + 0.04) / 2.
  Skeletons s;
  scene::add_cable(s, {5, 10, 10}, {0.5, 0, 0}, 21, 0.5f);
  scene::add_cable(s, {5, 10.9, 10}, {0.5, 0, 0}, 21, 0.5f);
  const Bodies bodies = make_bodies(s, 0.1);
  const conceg_box box = scene::box_of(40);
  CHECK_EQUAL(look(bodies, box, bodies.radius).overlapping > 0, 1);
  Cut result;
  const std::vector<double> radius = cut(bodies, box, 1, result);
  double mean = 0;
  for (std::size_t i = 0; i < bodies.points; i++) {
    CHECK_NEAR(radius[i], 0.43, 0.01);
    mean += radius[i] / 42;
  }
  CHECK_NEAR(mean, 0.43, 0.001);
  CHECK_EQUAL(result.constricted, 42);
  CHECK_NEAR(result.mean_share, 0.86, 0.002);
  CHECK_EQUAL(look(bodies, box, radius).overlapping, 0);
  CHECK(look(bodies, box, radius).smallest_gap >= gap - 1e-6);
}

void random_cells_come_apart() {
  const conceg_box box = scene::box_of(16);
  // Cells that ignore each other cross axis to axis; there the least radius is kept and the overlap is
  // reported.
  const Bodies bodies = make_bodies(scene::random_cells(21, 4, 400, 16, 1.5f, 0.4f), 0.1);
  const Certificate before = look(bodies, box, bodies.radius);
  Cut result;
  const std::vector<double> radius = cut(bodies, box, 1, result);
  const Certificate after = look(bodies, box, radius);
  printf("overlapping pairs %llu -> %llu, largest overlap %.3f -> %.3f um, %llu sweeps\n",
         (unsigned long long)before.overlapping, (unsigned long long)after.overlapping,
         before.largest_overlap, after.largest_overlap, (unsigned long long)result.sweeps);
  CHECK(before.overlapping > 100 && before.foreign > 0 && before.images > 0);
  CHECK(after.overlapping < before.overlapping / 4);
  CHECK(result.constricted > 0 && result.sweeps < 200);
  for (std::size_t i = 0; i < bodies.points; i++)
    CHECK(radius[i] >= bodies.floor[i] && radius[i] <= bodies.radius[i]);
  // What overlaps still is at its least radius on both sides (or a soma, or its neighbour in the cone is).
  for (const Pair &pair : scene::find(bodies, box, gap)) {
    RoundCone first, second;
    cones_of(bodies, pair, radius, side(box), first, second);
    const Closest at = closest_cones(first, second);
    if (at.gap >= gap - 1e-6) continue;
    const Element &e = bodies.elements[pair.e], &f = bodies.elements[pair.f];
    const double spare = (1 - at.s) * (radius[e.radius_a] - bodies.floor[e.radius_a]) +
                         at.s * (radius[e.radius_b] - bodies.floor[e.radius_b]) +
                         (1 - at.t) * (radius[f.radius_a] - bodies.floor[f.radius_a]) +
                         at.t * (radius[f.radius_b] - bodies.floor[f.radius_b]);
    CHECK(spare < 1e-3);
  }
  for (unsigned threads = 2; threads <= 3; threads++) {
    Cut other;
    const std::vector<double> again = cut(bodies, box, threads, other);
    CHECK(!memcmp(again.data(), radius.data(), radius.size() * sizeof radius[0]));
  }
}

void certificate_finds_a_planted_overlap() {
  const conceg_box box = scene::box_of(20);
  for (int axis = 0; axis < 3; axis++) {
    // Free of each other except through the face of one axis.
    glm::dvec3 a(10), b(10);
    a[axis] = 0.3, b[axis] = 19.7;
    glm::dvec3 step(0);
    step[(axis + 1) % 3] = 0.5;
    Skeletons s;
    scene::add_cable(s, a, step, 9, 0.2f);
    scene::add_cable(s, b, step, 9, 0.2f);
    Bodies bodies = make_bodies(s, 0.1);
    CHECK_EQUAL(look(bodies, box, bodies.radius).overlapping, 0);
    CHECK_NEAR(look(bodies, box, bodies.radius).smallest_gap, 0.2, 1e-6);
    std::vector<double> planted = bodies.radius;
    planted[4] = 0.45;
    const Certificate found = look(bodies, box, planted);
    CHECK(found.overlapping > 0);
    CHECK_NEAR(found.largest_overlap, 0.05, 1e-3);
  }
}

void rounding_down() {
  for (double x : {0.1, 0.43, 1.0 / 3, 0.5}) {
    const double y = static_cast<double>(not_above(x));
    CHECK(y <= x && y > x * (1 - 1e-7));
  }
}

} // namespace

int main() {
  parallel_cables_share_the_room();
  random_cells_come_apart();
  certificate_finds_a_planted_overlap();
  rounding_down();
  return check_done();
}
