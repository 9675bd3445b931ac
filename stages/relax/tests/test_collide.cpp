// SPDX-License-Identifier: BSD-3-Clause
// The collision search: Embree's candidates and the narrow test give what all pairs with all images give.
#include "check.h"
#include "scene.hpp"

#include <algorithm>
#include <string>
#include <tuple>

using namespace conceg;
using namespace conceg::relax;

namespace {

bool same(const std::vector<Pair> &x, const std::vector<Pair> &y) {
  return x.size() == y.size() && std::equal(x.begin(), x.end(), y.begin(), [](const Pair &p, const Pair &q) {
           return p.e == q.e && p.f == q.f && p.lift[0] == q.lift[0] && p.lift[1] == q.lift[1] &&
                  p.lift[2] == q.lift[2];
         });
}

// Every pair of elements with every image, in the order that the search promises.
std::vector<Pair> by_brute_force(const Bodies &bodies, const conceg_box &box, double reach, int images) {
  std::vector<Pair> pairs;
  const glm::dvec3 sides = side(box);
  const int n[3] = {box.periodic[0] ? images : 0, box.periodic[1] ? images : 0, box.periodic[2] ? images : 0};
  for (std::uint32_t e = 0; e < bodies.elements.size(); e++)
    for (std::uint32_t f = e; f < bodies.elements.size(); f++)
      for (int x = -n[0]; x <= n[0]; x++)
        for (int y = -n[1]; y <= n[1]; y++)
          for (int z = -n[2]; z <= n[2]; z++) {
            if (e == f && std::make_tuple(x, y, z) <= std::make_tuple(0, 0, 0)) continue;
            const Pair pair = {e, f, {x, y, z}};
            RoundCone first, second;
            cones_of(bodies, pair, bodies.radius, sides, first, second);
            const double thick =
                std::max(first.radius_a, first.radius_b) + std::max(second.radius_a, second.radius_b);
            first.radius_a = first.radius_b = second.radius_a = second.radius_b = 0;
            if (closest_axes(first, second).gap - thick >= reach) continue;
            if (same_copy(pair) && bodies.elements[e].cell == bodies.elements[f].cell &&
                near_in_tree(bodies, e, f))
              continue;
            pairs.push_back(pair);
          }
  return pairs;
}

void equals_brute_force(double size, bool periodic, int cells, int points, int images) {
  const Bodies bodies = make_bodies(scene::random_cells(7, cells, points, size, 1.5f, 0.4f), 0.1);
  const conceg_box box = scene::box_of(size, periodic);
  const std::vector<Pair> all = by_brute_force(bodies, box, 0.3, images);
  const std::vector<Pair> found = scene::find(bodies, box, 0.3);
  printf("box %g: %zu pairs by brute force, %zu by the search\n", size, all.size(), found.size());
  CHECK(all.size() > 100);
  CHECK(same(found, all));
  CHECK(same(found, scene::find(bodies, box, 0.3, 1)));
  CHECK(same(found, scene::find(bodies, box, 0.3, 3)));
}

// Two straight cables of one cell's length that meet their own image through the face of one axis.
void own_image_across_each_face() {
  for (int axis = 0; axis < 3; axis++) {
    const conceg_box box = scene::box_of(10);
    glm::dvec3 step(0);
    step[axis] = 1;
    Skeletons s;
    scene::add_cable(s, glm::dvec3(5), step, 11, 0.4f); // 10 um long: its end meets the image of its start
    const Bodies bodies = make_bodies(s, 0.1);
    const std::vector<Pair> pairs = scene::find(bodies, box, 0);
    CHECK(!pairs.empty());
    for (const Pair &p : pairs) {
      CHECK(p.lift[axis] != 0);
      CHECK(p.lift[(axis + 1) % 3] == 0 && p.lift[(axis + 2) % 3] == 0);
    }
    conceg_box open = box;
    open.periodic[axis] = 0;
    CHECK(scene::find(bodies, open, 0).empty());
  }
}

void neighbours_are_one_body() {
  Skeletons s;
  scene::add_cable(s, glm::dvec3(0), glm::dvec3(0.1, 0, 0), 100, 0.4f);
  CHECK(scene::find(make_bodies(s, 0.1), scene::box_of(100), 0.2).empty());
  // A hairpin: the cable comes back along itself. Planted: without the tree's distance it would count as
  // neighbours.
  s = {};
  scene::add_cable(s, glm::dvec3(0), glm::dvec3(0.5, 0, 0), 40, 0.4f);
  for (int i = 20; i < 40; i++)
    s.position[static_cast<std::size_t>(i)] = glm::dvec3(10 - 0.5 * (i - 20), 0.3, 0);
  CHECK(!scene::find(make_bodies(s, 0.1), scene::box_of(100), 0).empty());
}

void exact_distance_of_cones() {
  conceg_rng rng = conceg_rng_stream(3, "test.cones", 0);
  double worst = 0;
  for (int n = 0; n < 300; n++) {
    const auto point = [&] {
      return 2.0 * glm::dvec3{conceg_rng_uniform(&rng), conceg_rng_uniform(&rng), conceg_rng_uniform(&rng)};
    };
    const auto radius = [&] { return 0.1 + 0.5 * conceg_rng_uniform(&rng); };
    RoundCone a = {point(), point(), radius(), radius()}, b = {point(), point(), radius(), radius()};
    if (n % 10 == 0) b.a = a.a + glm::dvec3(0, 0, 1), b.b = a.b + glm::dvec3(0, 0, 1); // parallel
    if (n % 10 == 1) b.b = b.a;                                                        // a ball
    double least = 1e9;
    for (int i = 0; i <= 200; i++)
      for (int j = 0; j <= 200; j++) {
        const double s = i / 200.0, t = j / 200.0;
        least =
            std::min(least, glm::distance(a.a + s * (a.b - a.a), b.a + t * (b.b - b.a)) - a.radius_a -
                                s * (a.radius_b - a.radius_a) - b.radius_a - t * (b.radius_b - b.radius_a));
      }
    const double gap = closest_cones(a, b).gap;
    CHECK(gap <= least + 1e-9);
    if (least > 0) {
      worst = std::max(worst, least - gap);
      CHECK(gap > least - 2e-3); // the sampling's own error when apart
    }
    CHECK(closest_axes(a, b).gap >= gap - 1e-12);
    CHECK_NEAR(closest_cones(b, a).gap, gap, 1e-7);
  }
  printf("largest difference to sampling %.2g um\n", worst);
}

template <class Spoil> void rejects(const char *needle, Spoil spoil) {
  Skeletons s = scene::random_cells(1, 2, 50, 10, 1, 0.3f);
  spoil(s);
  bool thrown = false;
  try {
    make_bodies(s, 0.1);
  } catch (const Error &error) {
    thrown = std::string(error.what()).find(needle) != std::string::npos;
    if (!thrown) fprintf(stderr, "got: %s\n", error.what());
  }
  CHECK(thrown);
}

void bad_input() {
  rejects("/skeleton/radius[3]", [](Skeletons &s) { s.radius[3] = 0; });
  rejects("/skeleton/radius[4]", [](Skeletons &s) { s.radius[4] = NAN; });
  rejects("/skeleton/target_radius[5]", [](Skeletons &s) { s.target_radius[5] = -1; });
  rejects("/skeleton/position[6]", [](Skeletons &s) { s.position[6].y = INFINITY; });
  rejects("/skeleton/parent[7]", [](Skeletons &s) { s.parent[7] = 7; });
  rejects("/skeleton/parent[57]", [](Skeletons &s) { s.parent[57] = -2; });
  rejects("/skeleton/cell_offset", [](Skeletons &s) { s.cell_offset[1] = 1000; });
  rejects("/skeleton/cell_offset", [](Skeletons &s) { s.cell_offset.pop_back(); });
  rejects("/cells/radius[1]", [](Skeletons &s) { s.soma_radius[1] = NAN; });
}

} // namespace

int main() {
  equals_brute_force(12, true, 3, 80, 4);
  equals_brute_force(6, true, 2, 60, 7);
  equals_brute_force(8, false, 4, 300, 1);
  own_image_across_each_face();
  neighbours_are_one_body();
  exact_distance_of_cones();
  bad_input();
  return check_done();
}
