// SPDX-License-Identifier: BSD-3-Clause
// The base mesh against formulas and against its promises: closed, manifold, outward, disjoint, the same for
// any number of threads and wherever the box begins.
#include "check.h"
#include "check.hpp"
#include "pinch.hpp"
#include "scenes.hpp"

#include <cstring>

using namespace scenes;

namespace {

const double pi = 3.14159265358979323846;

CheckResult judge(const std::vector<Surface> &surfaces, const conceg_box &box, double gap = 0.06) {
  conceg::Workers workers(2);
  CheckOptions options;
  options.reach = 1.5 * gap;
  return check_surfaces(views_of(surfaces), box, options, workers, {});
}

// Every surface sound; prints the first flaw.
bool sound(const std::vector<Surface> &surfaces, const conceg_box &box, double *gap = nullptr) {
  const CheckResult result = judge(surfaces, box);
  for (const Defect &defect : result.defects) {
    std::fprintf(stderr, "%s\n", describe(defect, views_of(surfaces)).c_str());
    break;
  }
  if (gap) {
    *gap = 1;
    for (const double g : result.min_gap)
      *gap = std::min(*gap, g);
  }
  for (const std::uint8_t closed : result.closed)
    CHECK(closed);
  return result.defects.empty();
}

SceneOptions step(double h) {
  SceneOptions options;
  options.h = h;
  return options;
}

void balls_and_tubes_have_their_volume() {
  for (const double h : {0.8, 0.4, 0.2}) {
    Tissue tissue = empty_box(16);
    add_cell(tissue, {8.03, 7.9, 8.11}, 4);
    const Meshed mesh = mesh_of(tissue, step(h));
    CHECK(sound(mesh.surfaces, tissue.box));
    CHECK_EQUAL(euler_characteristic(mesh.surfaces[0]), 2);
    const double exact = 4.0 / 3 * pi * 64, area = 4 * pi * 16;
    CHECK_NEAR(volume_of(mesh.surfaces[0]), exact, 0.02 * h * h * exact);
    CHECK_NEAR(area_of(mesh.surfaces[0]), area, 0.02 * h * area);
  }
  // A tube's loss depends on its direction to the grid by about 2 %; the correction holds in the mean.
  for (const double radius : {0.3, 0.5}) {
    double mean = 0;
    const int count = 12;
    for (int turn = 0; turn < count; turn++) {
      conceg_rng rng = conceg_rng_stream(9, "test.tube", static_cast<std::uint64_t>(turn));
      Tissue tissue = empty_box(9);
      const glm::dvec3 along = 3.0 * random_direction(rng), centre(4.5 + conceg_rng_uniform(&rng), 4.5, 4.5);
      add_tube(tissue, centre - along, centre + along, radius);
      const double exact = pi * radius * radius * 6 + 4.0 / 3 * pi * radius * radius * radius;
      const double ratio = volume_of(mesh_of(tissue, step(radius / 2)).surfaces[0]) / exact;
      CHECK_NEAR(ratio, 1, 0.025);
      mean += ratio / count;
    }
    CHECK_NEAR(mean, 1, 0.006);
  }
}

void tubes_that_cross_are_parted() {
  Tissue tissue = empty_box(16);
  add_tube(tissue, {3, 8, 8}, {13, 8, 8}, 1.0);
  add_tube(tissue, {8, 3, 8.7}, {8, 13, 8.7}, 1.0);
  const Meshed mesh = mesh_of(tissue, step(0.25));
  double gap = 0;
  CHECK(sound(mesh.surfaces, tissue.box, &gap));
  CHECK(gap >= 0.06 / 1.91 && gap < 0.09);
  const double tube = pi * 10 + 4.0 / 3 * pi;
  for (const Surface &surface : mesh.surfaces)
    CHECK(volume_of(surface) < 0.97 * tube && volume_of(surface) > 0.6 * tube);
}

void tube_meets_its_own_image() {
  Tissue tissue = empty_box(10);
  add_tube(tissue, {1, 5, 5}, {9.8, 5, 5}, 0.8); // its two ends overlap across the face of the box
  const Meshed mesh = mesh_of(tissue, step(0.25));
  double gap = 0;
  CHECK(sound(mesh.surfaces, tissue.box, &gap));
  CHECK(gap < 0.09);
  CHECK_EQUAL(euler_characteristic(mesh.surfaces[0]), 2); // not a ring
  CHECK(volume_of(mesh.surfaces[0]) < 10 * pi * 0.64);
}

void four_cells_in_one_voxel() {
  Tissue tissue = empty_box(8);
  for (const glm::dvec3 &d :
       {glm::dvec3(1, 1, 1), glm::dvec3(1, -1, -1), glm::dvec3(-1, 1, -1), glm::dvec3(-1, -1, 1)})
    add_cell(tissue, glm::dvec3(4.06, 4.07, 4.05) + 0.9 * d, 1.7);
  const Meshed mesh = mesh_of(tissue, step(0.25));
  CHECK(sound(mesh.surfaces, tissue.box));
  for (const Surface &surface : mesh.surfaces)
    CHECK_EQUAL(euler_characteristic(surface), 2);
}

void cell_on_all_corners() {
  Tissue tissue = empty_box(8);
  add_cell(tissue, {0, 0, 0}, 2);
  const Meshed mesh = mesh_of(tissue, step(0.25));
  CHECK(sound(mesh.surfaces, tissue.box));
  CHECK_EQUAL(euler_characteristic(mesh.surfaces[0]), 2);
  CHECK_NEAR(volume_of(mesh.surfaces[0]), 4.0 / 3 * pi * 8, 0.4);
}

void thin_tube_stays_whole() {
  for (int turn = 0; turn < 8; turn++) {
    conceg_rng rng = conceg_rng_stream(5, "test.thin", static_cast<std::uint64_t>(turn));
    Tissue tissue = empty_box(12);
    const glm::dvec3 centre(6 + conceg_rng_uniform(&rng), 6 + conceg_rng_uniform(&rng),
                            6 + conceg_rng_uniform(&rng));
    const glm::dvec3 along = 4.0 * random_direction(rng);
    add_tube(tissue, centre - along, centre + along, 0.93 * 0.25);
    Meshed mesh = mesh_of(tissue, step(0.25));
    CHECK(sound(mesh.surfaces, tissue.box));
    CHECK_EQUAL(keep_soma_piece(mesh.surfaces[0], {}, false).detached, 0);
    CHECK_EQUAL(mesh.scene.thin_points[0], 0);
  }
}

void bits_differ_nowhere(const std::vector<Surface> &a, const std::vector<Surface> &b) {
  CHECK_EQUAL(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); i++) {
    CHECK_EQUAL(a[i].vertex.size(), b[i].vertex.size());
    CHECK_EQUAL(a[i].face.size(), b[i].face.size());
    if (a[i].vertex.size() != b[i].vertex.size() || a[i].face.size() != b[i].face.size()) continue;
    CHECK(std::memcmp(a[i].vertex.data(), b[i].vertex.data(), a[i].vertex.size() * sizeof(glm::vec3)) == 0);
    CHECK(std::memcmp(a[i].face.data(), b[i].face.data(), a[i].face.size() * sizeof(glm::uvec3)) == 0);
  }
}

void forest_is_sound_and_repeatable() {
  const Tissue tissue = forest(20, 3, 700, 11);
  const Meshed mesh = mesh_of(tissue, step(0.25));
  double gap = 0;
  CHECK(sound(mesh.surfaces, tissue.box, &gap));
  CHECK(gap >= 0.06 / 1.91);
  for (const unsigned threads : {2u, 3u})
    bits_differ_nowhere(mesh.surfaces, mesh_of(tissue, step(0.25), threads).surfaces);
  // Whole voxels, but not whole blocks.
  Tissue moved = tissue;
  const glm::dvec3 shift(0.25 * 5, -0.25 * 3, 0.25 * 21);
  for (glm::dvec3 &p : moved.soma)
    p += shift;
  for (glm::dvec3 &p : moved.point)
    p += shift;
  bits_differ_nowhere(mesh.surfaces, mesh_of(moved, step(0.25)).surfaces);
}

void uneven_box_and_open_sides() {
  Tissue tissue = empty_box(10, false);
  tissue.box.hi[1] = 11.3, tissue.box.periodic[2] = 1;
  add_cell(tissue, {1, 2, 5}, 2.5); // leaves the box on two open sides
  const std::int64_t root = add_point(tissue, {3.5, 2, 5}, 0.6, -1);
  add_point(tissue, {16, 9, 14}, 0.5, root); // far outside, and across the periodic side
  const Meshed mesh = mesh_of(tissue, step(0.25));
  CHECK(sound(mesh.surfaces, tissue.box));
  CHECK_EQUAL(euler_characteristic(mesh.surfaces[0]), 2);
  const double all = volume_of(mesh.surfaces[0]), inside = volume_inside(mesh.surfaces[0], tissue.box);
  CHECK(inside < 0.95 * all && inside > 0.5 * all);
}

void volume_inside_is_exact() {
  Tissue tissue = empty_box(8, false);
  add_cell(tissue, {0, 4, 4}, 2);
  const Meshed mesh = mesh_of(tissue, step(0.25));
  CHECK_NEAR(volume_inside(mesh.surfaces[0], tissue.box), 0.5 * volume_of(mesh.surfaces[0]), 0.02);
}

void pieces_are_found() {
  Tissue tissue = empty_box(20);
  add_cell(tissue, {5, 10, 10}, 2);
  const std::int64_t root = add_point(tissue, {7, 10, 10}, 0.5, -1);
  add_point(tissue, {17, 10, 10}, 0.5, root);
  add_cell(tissue, {12, 10, 10}, 1.5); // sits on the tube
  Meshed mesh = mesh_of(tissue, step(0.25));
  const double before = volume_of(mesh.surfaces[0]);
  conceg::Workers workers(2);
  const std::vector<Pinch> pinches = predict_pinches(mesh.scene, mesh.index, workers);
  CHECK(pinches.size() == 1 && pinches[0].cell == 0); // foreseen, named
  const Pieces pieces = keep_soma_piece(mesh.surfaces[0], {}, true);
  CHECK_EQUAL(pieces.detached, 1);
  CHECK(pieces.soma_found);
  CHECK_NEAR(pieces.detached_volume, pi * 0.25 * 3.5, 0.8);
  CHECK_NEAR(volume_of(mesh.surfaces[0]) + pieces.detached_volume, before, 1e-3);
  CHECK(sound(mesh.surfaces, tissue.box));
  CHECK_EQUAL(euler_characteristic(mesh.surfaces[0]), 2);
}

// A tube that a neighbour's contact plane cuts: what is left of it decides, not its radius.
void pinches_are_foreseen() {
  for (const double distance : {0.75, 0.95, 1.3}) { // between the axes of tubes of 0.5 um
    Tissue tissue = empty_box(20);
    add_cell(tissue, {5, 10, 10}, 0);
    const std::int64_t first = add_point(tissue, {3, 10, 10}, 0.5, -1);
    std::int64_t at = add_point(tissue, {10, 10, 10}, 0.5, first);
    add_point(tissue, {17, 10, 10}, 0.5, at);
    add_tube(tissue, {10, 3, 10 + distance}, {10, 17, 10 + distance}, 0.5);
    const Meshed mesh = mesh_of(tissue, step(0.4));
    conceg::Workers workers(1);
    const std::vector<Pinch> pinches = predict_pinches(mesh.scene, mesh.index, workers);
    const double grown = mesh.scene.cone[0].rb / double(kFixed) * mesh.scene.grid.unit;
    const double left = 0.5 * (grown + (distance - grown) - 0.06);
    CHECK_EQUAL(!pinches.empty(), left < kThinnestTube * 0.4);
    if (!pinches.empty()) CHECK_NEAR(pinches[0].left_um, left, 0.01);
  }
}

void inflation_fills() {
  const Tissue tissue = forest(20, 3, 700, 11);
  SceneOptions options = step(0.4);
  double thin = 0, fat = 0;
  for (const Surface &surface : mesh_of(tissue, options).surfaces)
    thin += volume_of(surface);
  options.inflate = 0.1;
  const Meshed mesh = mesh_of(tissue, options);
  for (const Surface &surface : mesh.surfaces)
    fat += volume_of(surface);
  CHECK(fat > 1.05 * thin);
  CHECK(sound(mesh.surfaces, tissue.box));
}

} // namespace

int main() {
  balls_and_tubes_have_their_volume();
  tubes_that_cross_are_parted();
  tube_meets_its_own_image();
  four_cells_in_one_voxel();
  cell_on_all_corners();
  thin_tube_stays_whole();
  forest_is_sound_and_repeatable();
  uneven_box_and_open_sides();
  volume_inside_is_exact();
  pieces_are_found();
  pinches_are_foreseen();
  inflation_fills();
  return check_done();
}
