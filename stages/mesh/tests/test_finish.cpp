// SPDX-License-Identifier: BSD-3-Clause
// Simplified meshes: light, near the base mesh, sound and apart; the repair works; faces and memory.
#include "check.h"
#include "distance.hpp"
#include "faces.hpp"
#include "finish.hpp"
#include "scenes.hpp"
#include "simplify.hpp"

#include <cstring>
#include <sys/resource.h>

using namespace scenes;

namespace {

std::size_t faces(const std::vector<Surface> &surfaces) {
  std::size_t sum = 0;
  for (const Surface &surface : surfaces)
    sum += surface.face.size();
  return sum;
}

// Of every vertex; simplification knows no other points.
double farthest_vertex(const Surface &from, const Surface &to) {
  double worst = 0;
  for (std::uint32_t v = 0; v < from.vertex.size(); v++) {
    double least = 1e9;
    for (const glm::uvec3 &f : to.face) {
      const Corners t = {to.at(f.x), to.at(f.y), to.at(f.z)};
      least = std::min(least, point_triangle_distance2(from.at(v), t));
    }
    worst = std::max(worst, std::sqrt(least));
  }
  return worst;
}

// Largest distance from the vertices and face centres of one surface to another surface.
double farthest(const Surface &from, const Surface &to) {
  double worst = 0;
  std::vector<glm::dvec3> samples;
  for (std::uint32_t v = 0; v < from.vertex.size(); v++)
    samples.push_back(from.at(v));
  for (const glm::uvec3 &f : from.face)
    samples.push_back((from.at(f.x) + from.at(f.y) + from.at(f.z)) / 3.0);
  const std::size_t stride = 1 + samples.size() / 400;
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    double least = 1e9;
    for (const glm::uvec3 &f : to.face) {
      const Corners t = {to.at(f.x), to.at(f.y), to.at(f.z)};
      least = std::min(least, point_triangle_distance2(samples[i], t));
    }
    worst = std::max(worst, std::sqrt(least));
  }
  return worst;
}

void simplified_stays_near() {
  Tissue tissue = empty_box(16);
  add_cell(tissue, {6, 8, 8}, 2.5);
  std::int64_t at = add_point(tissue, {8.5, 8, 8}, 0.6, -1);
  at = add_point(tissue, {11, 9, 8.5}, 0.4, at);
  add_point(tissue, {13, 10, 9.5}, 0.35, at);
  add_point(tissue, {12, 7, 8}, 0.3, at);
  SceneOptions options;
  options.h = 0.2;
  const Meshed mesh = mesh_of(tissue, options);
  for (const double tolerance : {0.01, 0.02, 0.04, 0.08}) {
    const Surface light =
        simplify(mesh.surfaces[0],
                 std::vector<float>(mesh.surfaces[0].vertex.size(), static_cast<float>(tolerance)), {});
    std::printf("tolerance %.3f: %zu -> %zu faces, there %.4f, back %.4f um\n", tolerance,
                mesh.surfaces[0].face.size(), light.face.size(), farthest(light, mesh.surfaces[0]),
                farthest(mesh.surfaces[0], light));
    CHECK(farthest(light, mesh.surfaces[0]) <= tolerance);
    CHECK(farthest(mesh.surfaces[0], light) <= tolerance);
    CHECK(light.face.size() < mesh.surfaces[0].face.size() / 2);
    CHECK_NEAR(volume_of(light), volume_of(mesh.surfaces[0]), 0.25 * tolerance * area_of(mesh.surfaces[0]));
    CHECK_EQUAL(euler_characteristic(light), 2);
  }
  const std::vector<float> locked(mesh.surfaces[0].vertex.size());
  CHECK_EQUAL(simplify(mesh.surfaces[0], locked, {}).face.size(), mesh.surfaces[0].face.size());
}

// A tube as wide as most of tissue: far fewer faces than the grid has, and no vertex of either surface
// farther from the other than asked.
void tubes_become_light() {
  Tissue tissue = empty_box(16);
  add_tube(tissue, {3, 7, 8}, {12, 9.5, 10}, 0.42);
  SceneOptions options;
  options.h = 0.2;
  const Surface tube = mesh_of(tissue, options, 1, true, true).surfaces[0];
  for (const double tolerance : {0.01, 0.02}) {
    const Surface light =
        simplify(tube, std::vector<float>(tube.vertex.size(), static_cast<float>(tolerance)), {});
    const double density = double(light.face.size()) / area_of(light), there = farthest_vertex(light, tube),
                 back = farthest_vertex(tube, light);
    std::printf("tube, tolerance %.3f: %.1f -> %.1f faces per um2, there %.4f, back %.4f um\n", tolerance,
                double(tube.face.size()) / area_of(tube), density, there, back);
    CHECK(density < 0.3 / tolerance);
    CHECK(there <= tolerance + 1e-7 &&
          back <= tolerance + 1e-7); // the last digit is that of single precision
    CHECK_NEAR(volume_of(light) / volume_of(tube), 1, 1e-3);
    CHECK_EQUAL(euler_characteristic(light), 2);
  }
}

Done finish_forest(const Tissue &tissue, double tolerance, unsigned threads, bool cluster = true,
                   double gap = 0.06) {
  SceneOptions options;
  options.h = 0.25;
  FinishOptions finish_options;
  finish_options.tolerance = tolerance, finish_options.cluster = cluster, finish_options.gap = gap,
  finish_options.rounds = 2;
  return finish_tissue(tissue, options, finish_options, threads);
}

void same_bytes(const Done &one, const Done &other) {
  CHECK_EQUAL(one.surfaces.size(), other.surfaces.size());
  for (std::size_t i = 0; i < one.surfaces.size(); i++) {
    const Surface &a = one.surfaces[i], &b = other.surfaces[i];
    CHECK(a.vertex.size() == b.vertex.size() && a.face.size() == b.face.size() &&
          std::memcmp(a.vertex.data(), b.vertex.data(), a.vertex.size() * sizeof a.vertex[0]) == 0 &&
          std::memcmp(a.face.data(), b.face.data(), a.face.size() * sizeof a.face[0]) == 0);
  }
}

void sound_and_apart(const Done &done) {
  CHECK_EQUAL(done.check.errors, 0);
  for (const double gap : done.check.min_gap)
    CHECK(gap >= 0.03); // half of what is asked
}

double volume(const Done &done) {
  double sum = 0;
  for (const Surface &surface : done.surfaces)
    sum += volume_of(surface);
  return sum;
}

// The light mesh: a third of the faces, the same tissue; simplified further where neighbours are far.
void forest_is_light_and_sound() {
  const Tissue tissue = forest(20, 2, 1200, 3);
  const Done one = finish_forest(tissue, 0.05, 1), three = finish_forest(tissue, 0.05, 3);
  sound_and_apart(one);
  same_bytes(one, three);
  const Done base = finish_forest(tissue, 0, 2, false), clustered = finish_forest(tissue, 0, 2);
  sound_and_apart(base), sound_and_apart(clustered);
  CHECK(faces(clustered.surfaces) < 0.34 * double(faces(base.surfaces)));
  CHECK(faces(one.surfaces) < 0.15 * double(faces(base.surfaces)));
  std::printf("forest: base %zu faces, light %zu, simplified %zu; volumes %.1f %.1f %.1f\n",
              faces(base.surfaces), faces(clustered.surfaces), faces(one.surfaces), volume(base),
              volume(clustered), volume(one));
  // A light mesh differs from the base mesh by the corners that a cluster cuts.
  CHECK_NEAR(volume(clustered) / volume(base), 1, 0.02);
  // A gap is asked for that no mesh keeps: the repair ends at the base mesh, and that is sound.
  const Done wide = finish_forest(tissue, 0.05, 2, true, 0.8);
  std::printf("wide gap: %d rounds, %zu faces\n", wide.rounds, faces(wide.surfaces));
  CHECK(wide.repaired_pairs > 0 && wide.rounds > 0);
  CHECK_EQUAL(wide.check.errors, 0);
  CHECK(faces(wide.surfaces) > 2 * faces(clustered.surfaces));
  for (const double gap : wide.check.min_gap)
    CHECK(gap >= 0.06 / 1.91);
}

// Wavy tubes that press on one another, each a cell of its own.
Tissue bundle(int across) {
  Tissue tissue = empty_box(12);
  for (int i = 0; i < across * across; i++) {
    const double x = 1.5 + 1.1 * (i % across), z = 1.5 + 1.1 * (i / across);
    add_cell(tissue, {x, 1, z}, 0);
    std::int64_t last = -1;
    for (int k = 0; k <= 20; k++)
      last = add_point(
          tissue, {x + 0.35 * conceg_sin(0.7 * k + i), 1 + 0.5 * k, z + 0.35 * conceg_cos(0.9 * k + 2 * i)},
          0.7 + 0.13 * conceg_sin(1.3 * k + 3 * i), last);
  }
  return tissue;
}

// Clusters of coarse steps take more from the gap than it has: faces are moved apart, hardly a surface is
// made again, and the meshes stay light.
void coarse_meshes_stay_light() {
  const Tissue tissue = bundle(8);
  SceneOptions options;
  options.h = 0.4, options.gap = 0.04;
  FinishOptions finish_options;
  finish_options.gap = 0.04;
  const Done done = finish_tissue(tissue, options, finish_options, 2),
             other = finish_tissue(tissue, options, finish_options, 3);
  finish_options.tolerance = 0;
  const Done light = finish_tissue(tissue, options, finish_options, 2);
  std::printf("bundle: %llu vertices moved, %d rounds; %zu faces, not simplified %zu; volumes %.1f %.1f\n",
              static_cast<unsigned long long>(done.moved_vertices), done.rounds, faces(done.surfaces),
              faces(light.surfaces), volume(done), volume(light));
  same_bytes(done, other);
  CHECK(done.moved_vertices > 100);
  CHECK(done.rounds <= 3);
  CHECK(faces(done.surfaces) < 0.9 * double(faces(light.surfaces)));
  CHECK_NEAR(volume(done) / volume(light), 1, 0.002);
  CHECK_EQUAL(done.check.errors, 0);
  for (const double gap : done.check.min_gap)
    CHECK(gap >= 0.02);
}

// Where the grid is coarse beside the tubes, cells become their base meshes at once and meet light
// neighbours: these go back too, beyond the rounds that were planned.
void light_neighbours_go_back() {
  SceneOptions options;
  options.h = 0.5;
  FinishOptions finish_options;
  finish_options.gap = 0.1, finish_options.rounds = 1, finish_options.nudge = false;
  const Done done = finish_tissue(forest(20, 12, 300, 3), options, finish_options, 2);
  std::printf("coarse forest: %d rounds, %llu places repaired\n", done.rounds,
              static_cast<unsigned long long>(done.repaired_pairs));
  CHECK(done.rounds > finish_options.rounds);
  sound_and_apart(done);
}

// A check of what was replaced finds what a check of everything finds.
void checking_again_is_checking() {
  const Tissue tissue = forest(20, 2, 600, 3);
  SceneOptions options;
  options.h = 0.3;
  std::vector<Surface> surfaces = mesh_of(tissue, options, 2, true, true).surfaces;
  conceg::Workers workers(2);
  CheckResult result = check_surfaces(views_of(surfaces), tissue.box, {}, workers, {});
  surfaces[1].origin += glm::dvec3(0.3, 0, 0);
  check_again(views_of(surfaces), {{0, 1}}, tissue.box, {}, workers, {}, result);
  const CheckResult whole = check_surfaces(views_of(surfaces), tissue.box, {}, workers, {});
  CHECK(whole.crossings > 0);
  CHECK_EQUAL(result.crossings, whole.crossings);
  CHECK_EQUAL(result.defects.size(), whole.defects.size());
  CHECK_NEAR(result.min_gap[1], whole.min_gap[1], 0);
}

void faces_know_where_they_belong() {
  Tissue tissue = empty_box(20);
  add_cell(tissue, {6, 10, 10}, 2);
  std::int64_t at = add_point(tissue, {8, 10, 10}, 0.6, -1, 4);
  at = add_point(tissue, {12, 10, 10}, 0.6, at, 4);
  add_point(tissue, {15, 13, 10}, 0.5, at, 4);
  add_point(tissue, {15, 7, 10}, 0.5, at, 3);
  SceneOptions options;
  options.h = 0.25;
  const Meshed mesh = mesh_of(tissue, options);
  const Surface &surface = mesh.surfaces[0];
  for (std::size_t f = 0; f < surface.face.size(); f++) {
    const glm::dvec3 p =
        (surface.at(surface.face[f].x) + surface.at(surface.face[f].y) + surface.at(surface.face[f].z)) / 3.0;
    const FaceLabel label = label_face(mesh.scene, mesh.index, surface, f);
    const std::uint8_t kind = label.compartment;
    if (p.x < 7) CHECK(kind == kSomaKind && label.section == kNoSection);
    if (p.x > 9.5 && p.x < 11.5) CHECK(kind == 4 && label.section == 0);
    if (p.x > 13 && p.y > 10) CHECK(kind == 4 && label.section == 1);
    if (p.x > 13 && p.y < 10) CHECK(kind == 3 && label.section == 2);
  }
}

void memory_stays_bounded() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  CHECK(usage.ru_maxrss < 500 * 1024);
}

} // namespace

int main() {
  simplified_stays_near();
  tubes_become_light();
  forest_is_light_and_sound();
  coarse_meshes_stay_light();
  light_neighbours_go_back();
  checking_again_is_checking();
  faces_know_where_they_belong();
  memory_stays_bounded();
  return check_done();
}
