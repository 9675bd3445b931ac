// SPDX-License-Identifier: BSD-3-Clause
// The extracellular space: volume against formula, a hollow cell that shuts a piece of it in, any threads.
#include "../space.hpp"
#include "check.h"

#include <cmath>

using namespace conceg;
using namespace conceg::mesh;

namespace {

Tissue box_of(double size) {
  Tissue tissue;
  for (int a = 0; a < 3; a++)
    tissue.box.hi[a] = size, tissue.box.periodic[a] = 1;
  tissue.offset.push_back(0);
  return tissue;
}

void add_ball(Tissue &tissue, const glm::dvec3 &centre, float radius) {
  tissue.soma.push_back(centre), tissue.soma_radius.push_back(radius);
  tissue.offset.push_back(tissue.point.size());
}

Space space_of(const Tissue &tissue, double h, unsigned threads) {
  SceneOptions options;
  options.h = h;
  const Scene scene = make_scene(tissue, options);
  Workers workers(threads);
  return extracellular_space(scene, make_index(scene, workers, {}), workers, {});
}

void ball_by_formula() {
  Tissue tissue = box_of(8);
  add_ball(tissue, {0.3, 7.9, 4.1}, 2.5f); // across faces
  const Space space = space_of(tissue, 0.2, 2);
  const double expected = 1 - 4.0 / 3 * std::acos(-1.0) * 2.5 * 2.5 * 2.5 / 512;
  printf("space beside a ball: %.5f, by formula %.5f\n", space.volume, expected);
  CHECK_NEAR(space.volume, expected, 0.001);
  CHECK_EQUAL(space.pieces, 1);
  CHECK_NEAR(space.largest, 1, 1e-12);
}

// A closed shell of one cell: a chain over a fine spiral around a ball; the inside is a piece of its own.
void shell_shuts_in() {
  Tissue tissue = box_of(10);
  tissue.soma.push_back({5, 5, 5}), tissue.soma_radius.push_back(0);
  const double radius = 3;
  const int count = 4000;
  for (int i = 0; i < count; i++) {
    const double z = -1 + 2 * (i + 0.5) / count, angle = 0.2 * i, across = std::sqrt(1 - z * z);
    tissue.point.push_back(glm::dvec3(5) +
                           radius * glm::dvec3(across * std::cos(angle), across * std::sin(angle), z));
    tissue.radius.push_back(0.4f), tissue.parent.push_back(i - 1), tissue.kind.push_back(2);
  }
  tissue.offset.push_back(tissue.point.size());
  const Space one = space_of(tissue, 0.2, 1), two = space_of(tissue, 0.2, 2);
  printf("shell: %llu pieces, %.4f of the space in the largest\n", (unsigned long long)one.pieces,
         one.largest);
  CHECK_EQUAL(one.pieces, 2);
  const double inner = 4.0 / 3 * std::acos(-1.0) * 2.6 * 2.6 * 2.6 / 1000;
  CHECK_NEAR((1 - one.largest) * one.volume, inner, 0.1 * inner);
  CHECK(one.pieces == two.pieces && one.volume == two.volume && one.largest == two.largest);
}

// Two cells in contact keep a gap between them, through which the space is joined, as thin as it is.
void contact_leaves_a_gap() {
  Tissue tissue = box_of(6);
  for (int i = 0; i < 2; i++)
    add_ball(tissue, {1.5 + 3 * i, 3, 3}, 2.2f); // overlap with each other and with the images
  const Space space = space_of(tissue, 0.2, 1);
  CHECK_EQUAL(space.pieces, 1);
}

void open_sides_are_refused() {
  Tissue tissue = box_of(6);
  tissue.box.periodic[2] = 0;
  add_ball(tissue, {3, 3, 3}, 1);
  bool refused = false;
  try {
    space_of(tissue, 0.3, 1);
  } catch (const Error &error) {
    refused = error.status() == CONCEG_E_UNSUPPORTED;
  }
  CHECK(refused);
}

} // namespace

int main() {
  ball_by_formula();
  shell_shuts_in();
  contact_leaves_a_gap();
  open_sides_are_refused();
  return check_done();
}
