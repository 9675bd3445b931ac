// SPDX-License-Identifier: BSD-3-Clause
// Sections and their figures on a tree that can be worked out by hand; lengths, straightness and fork angles
// are kept by crowded cells, and are not when what keeps them is switched off.
#include "../pack.hpp"
#include "check.h"
#include "scene.hpp"

#include <cmath>
#include <cstring>

using namespace conceg;
using namespace conceg::relax;

namespace {

constexpr double pi = 3.14159265358979323846;

// A root, 4 um along x to a fork, and two daughters of 3 um at 90 degrees, one of them with a right-angled
// bend.
Skeletons tree() {
  Skeletons s;
  const glm::dvec3 points[] = {{0, 0, 0},     {2, 0, 0},   {4, 0, 0}, {4, 1.5, 0},
                               {5.5, 1.5, 0}, {5.5, 0, 0}, {7, 0, 0}};
  const std::int64_t parents[] = {-1, 0, 1, 2, 3, 2, 5};
  s.cell_offset = {0, 7};
  for (int i = 0; i < 7; i++) {
    s.position.push_back(points[i]), s.parent.push_back(parents[i]);
    s.radius.push_back(0.2f), s.target_radius.push_back(0.2f);
  }
  s.soma.push_back({0, 0, 0}), s.soma_radius.push_back(0);
  return s;
}

void known_tree() {
  const Bodies bodies = make_bodies(tree(), 0.1);
  const Sections sections = make_sections(bodies);
  CHECK_EQUAL(sections.count(), 3u);
  CHECK(sections.of_point == std::vector<std::uint32_t>({no_section, 0, 0, 1, 1, 2, 2}));
  CHECK(sections.point == std::vector<std::uint32_t>({0, 1, 2, 2, 3, 4, 2, 5, 6}));
  Workers workers(1);
  const Shape shape = measure_shape(bodies, sections, workers);
  CHECK_NEAR(shape.length[0], 4, 1e-12);
  CHECK_NEAR(shape.length[1], 3, 1e-12);
  CHECK_NEAR(shape.straightness[0], 1, 1e-12);
  // Resampled every 1 um the bend is cut: 1 + sqrt(0.5) + 1 of path.
  CHECK_NEAR(shape.straightness[1], std::sqrt(4.5) / (2 + std::sqrt(0.5)), 1e-9);
  CHECK_EQUAL(shape.angle.size(), 1u);
  CHECK_NEAR(shape.angle[0], pi / 2, 1e-12);
}

void changes_are_seen() {
  Bodies bodies = make_bodies(tree(), 0.1);
  const Sections sections = make_sections(bodies);
  Workers workers(1);
  const Shape before = measure_shape(bodies, sections, workers);
  const ShapeChange none = compare_shapes(before, before);
  CHECK(none.length_within == 1 && none.angle_within == 1 && none.worst_length_change == 0);
  bodies.position[6] = {7.3, 0, 0}; // 3.0 -> 3.3 um
  bodies.position[3] = {4.15, 1.5, 0};
  const ShapeChange change = compare_shapes(before, measure_shape(bodies, sections, workers));
  CHECK_NEAR(change.worst_length_change, 0.1, 1e-9);
  CHECK_NEAR(change.length_within, 1.0 / 3, 1e-9); // the bent one is 0.14 um shorter now
  CHECK_EQUAL(change.angle_within, 0);
  CHECK(change.mean_angle_after < change.mean_angle_before);
}

ShapeChange crowd(const Strength &strength) {
  Bodies bodies = make_bodies(scene::random_cells(3, 6, 400, 14, 1.5f, 0.4f), 0.15);
  const Sections sections = make_sections(bodies);
  Workers workers(2);
  Collider collider(2);
  const Shape before = measure_shape(bodies, sections, workers);
  move_bodies(bodies, sections, scene::box_of(14), strength, Motion(), collider, workers, {});
  const ShapeChange change = compare_shapes(before, measure_shape(bodies, sections, workers));
  printf("%zu sections: %.3f within 3 %% of their length, straightness %.4f -> %.4f, fork angle %.2f -> %.2f "
         "degrees, %.2f of %zu forks within 3\n",
         change.sections, change.length_within, change.straightness_before, change.straightness_after,
         change.mean_angle_before * 180 / pi, change.mean_angle_after * 180 / pi, change.angle_within,
         change.forks);
  return change;
}

void crowded_cells_keep_their_shape() {
  const ShapeChange kept = crowd(Strength());
  CHECK(kept.sections > 90);
  CHECK(kept.length_within > 0.97);
  CHECK(kept.straightness_after > kept.straightness_before - 0.005);
  CHECK(kept.forks > 30 && kept.angle_within > 0.5);
  CHECK(std::abs(kept.mean_angle_after - kept.mean_angle_before) < 3 * pi / 180);
  Strength loose;
  loose.tension = loose.straightening = loose.forking = 0;
  const ShapeChange lost = crowd(loose);
  CHECK(lost.length_within < kept.length_within);
  CHECK(lost.straightness_after < kept.straightness_after);
  CHECK(lost.angle_within < 0.5 * kept.angle_within);
}

} // namespace

int main() {
  known_tree();
  changes_are_seen();
  crowded_cells_keep_their_shape();
  return check_done();
}
