// SPDX-License-Identifier: BSD-3-Clause
// The voxels against formulas, the meshes and OpenVDB: distances of a ball and of a cone, labels where cells
// meet, volume fractions, the .vdb read back by OpenVDB, the same bytes for any number of threads.
#include "check.h"
#include "guard.hpp"
#include "scenes.hpp"

#include <cstdio>
#include <cstring>

#ifdef CONCEG_HAS_OPENVDB
#include <openvdb/openvdb.h>
#endif

using namespace scenes;

namespace {

const double pi = 3.14159265358979323846;
// Centres and radii are rounded to 2^-8 of a step: half of that on each axis, and of a radius.
const double rounding = (std::sqrt(3.0) + 1) / 512;

SceneOptions step(double h) {
  SceneOptions options;
  options.h = h;
  return options;
}

glm::dvec3 place_of(const Volume &volume, std::size_t value) {
  const std::size_t voxel = value % kLeafVoxels;
  const glm::ivec3 at =
      volume.layout.leaf_origin[value / kLeafVoxels] + glm::ivec3(voxel / 64, voxel / 8 % 8, voxel % 8);
  return volume.layout.origin() + glm::dvec3(at) * volume.layout.spacing();
}

bool in_box(const Volume &volume, const glm::dvec3 &p, const conceg_box &box) {
  for (int axis = 0; axis < 3; axis++)
    if (p[axis] > box.hi[axis]) return false; // beyond the last voxel of the box
  return volume.layout.leaf_origin.size() > 0;
}

// Signed distance to a round cone as the union of the balls along it: the least over the place on the axis,
// by golden sections (the function is convex there).
double cone_by_balls(const glm::dvec3 &p, const glm::dvec3 &a, const glm::dvec3 &b, double ra, double rb) {
  const auto ball = [&](double t) { return glm::length(p - (a + t * (b - a))) - (ra + t * (rb - ra)); };
  double low = 0, high = 1;
  const double ratio = 0.6180339887498949;
  for (int turn = 0; turn < 60; turn++) {
    const double left = high - ratio * (high - low), right = low + ratio * (high - low);
    (ball(left) < ball(right) ? high : low) = ball(left) < ball(right) ? right : left;
  }
  return std::min({ball(0.5 * (low + high)), ball(0), ball(1)});
}

// Compares every voxel with a distance function cut to the band; returns how many lie within the band.
template <class Exact>
std::size_t distances_are(const Volume &volume, const conceg_box &box, double allowed, Exact exact) {
  std::size_t within = 0, wrong = 0;
  double worst = 0;
  const double band = volume.layout.band;
  for (std::size_t i = 0; i < volume.distance.size(); i++) {
    const glm::dvec3 p = place_of(volume, i);
    if (!in_box(volume, p, box)) continue;
    const double wanted = std::max(-band, std::min(band, exact(p))), error = volume.distance[i] - wanted;
    within += std::fabs(wanted) < band;
    worst = std::max(worst, std::fabs(error));
    wrong += !(std::fabs(error) <= allowed) || (volume.label[i] != 0) != (volume.distance[i] < 0);
  }
  std::printf("%zu voxels in the band, largest error %.2g um, allowed %.2g\n", within, worst, allowed);
  CHECK_EQUAL(wrong, 0);
  return within;
}

double nearest_image(const glm::dvec3 &p, double side, double (*exact)(const glm::dvec3 &)) {
  double least = 1e9;
  for (int x = -1; x <= 1; x++)
    for (int y = -1; y <= 1; y++)
      for (int z = -1; z <= 1; z++)
        least = std::min(least, exact(p + side * glm::dvec3(x, y, z)));
  return least;
}

void ball_and_cone_have_their_distance() {
  Tissue ball = empty_box(16);
  add_cell(ball, {15.03, 7.9, 0.11}, 4); // across an edge of the box
  const double h = 0.31;                 // 52 voxels: the last leaves reach beyond the box
  const Volume of_ball = volume_of_tissue(ball, step(h));
  CHECK_EQUAL(of_ball.layout.shape().x, 52);
  const std::size_t within = distances_are(of_ball, ball.box, rounding * h + 1e-5, [](const glm::dvec3 &p) {
    return nearest_image(
        p, 16, [](const glm::dvec3 &q) { return glm::length(q - glm::dvec3(15.03, 7.9, 0.11)) - 4; });
  });
  // All of the band is there: its volume in voxels.
  const double band = of_ball.layout.band, unit = 16.0 / 52,
               shell = 4.0 / 3 * pi * (std::pow(4 + band, 3) - std::pow(4 - band, 3)) / std::pow(unit, 3);
  CHECK_NEAR(double(within) / shell, 1, 0.01);

  Tissue tube = empty_box(16);
  add_cell(tube, {8, 8, 8}, 0);
  add_point(tube, {4.2, 5.1, 8.3}, 1.4, -1);
  add_point(tube, {19.1, 9.7, 6.2}, 0.4, 0); // tapers, and leaves the box
  const std::size_t tapered = distances_are(
      volume_of_tissue(tube, step(0.25)), tube.box, 2 * rounding * 0.25 + 1e-5, [](const glm::dvec3 &p) {
        return nearest_image(p, 16, [](const glm::dvec3 &q) {
          return cone_by_balls(q, {4.2, 5.1, 8.3}, {19.1, 9.7, 6.2}, double(1.4f), double(0.4f));
        });
      });
  CHECK(tapered > 5000);
}

// Equation 3: the nearer cell wins, and keeps half the gap from the plane between.
void nearer_cell_wins() {
  Tissue tissue = empty_box(16);
  add_cell(tissue, {6.02, 8, 8}, 2.5);
  add_cell(tissue, {9.51, 8.2, 8.1}, 2);
  SceneOptions options = step(0.25);
  options.gap = 0.1;
  const Volume volume = volume_of_tissue(tissue, options);
  std::size_t first = 0, second = 0, between = 0, wrong = 0;
  for (std::size_t i = 0; i < volume.label.size(); i++) {
    const glm::dvec3 p = place_of(volume, i);
    const double a = glm::length(p - tissue.soma[0]) - 2.5, b = glm::length(p - tissue.soma[1]) - 2;
    const double of_a = std::max(a, (a - b) / 2 + 0.05), of_b = std::max(b, (b - a) / 2 + 0.05),
                 least = std::min(of_a, of_b);
    if (std::fabs(of_a) < 2 * rounding * 0.25 || std::fabs(of_b) < 2 * rounding * 0.25)
      continue; // rounding decides
    const std::uint32_t wanted = of_a < 0 ? 1 : of_b < 0 ? 2 : 0;
    wrong += volume.label[i] != wanted;
    if (std::fabs(least) < 0.45)
      wrong += !(std::fabs(volume.distance[i] - least) < 2 * rounding * 0.25 + 1e-5);
    first += wanted == 1, second += wanted == 2, between += wanted == 0 && a < 0 && b < 0;
  }
  CHECK_EQUAL(wrong, 0);
  CHECK(first > 1000 && second > 1000 && between > 3);
}

double share_inside(const Volume &volume) {
  std::size_t inside = 0;
  for (const std::uint32_t label : volume.label)
    inside += label != 0;
  const glm::dvec3 voxels(volume.layout.shape());
  return double(inside) / (voxels.x * voxels.y * voxels.z);
}

void labels_fill_what_cells_fill() {
  Tissue ball = empty_box(16);
  add_cell(ball, {0.3, 0.2, 15.8}, 4);
  CHECK_NEAR(share_inside(volume_of_tissue(ball, step(0.25))), 4.0 / 3 * pi * 64 / 4096, 2e-4);
  const Tissue tissue = forest(20, 2, 600, 3);
  const Volume volume = volume_of_tissue(tissue, step(0.25));
  CHECK_EQUAL(volume.layout.shape().x, 80);
  CHECK_NEAR(volume.layout.origin().x, 0.125, 1e-12);
  double meshes = 0;
  for (const Surface &surface : mesh_of(tissue, step(0.25)).surfaces)
    meshes += volume_of(surface);
  CHECK_NEAR(share_inside(volume), meshes / 8000, 0.002);
  // The field itself, on voxels of half the size.
  CHECK_NEAR(share_inside(volume), share_inside(volume_of_tissue(tissue, step(0.125))), 0.001);
  for (const unsigned threads : {2u, 3u}) {
    const Volume again = volume_of_tissue(tissue, step(0.25), threads);
    CHECK(again.label == volume.label && again.distance == volume.distance);
    CHECK(again.layout.leaf_origin == volume.layout.leaf_origin);
  }
}

void folder_that_is_not_there() {
  Tissue ball = empty_box(8);
  add_cell(ball, {4, 4, 4}, 2);
  const Volume volume = volume_of_tissue(ball, step(0.5));
  conceg_status status = CONCEG_OK;
  try {
    conceg::write_vdb(leaves(volume.layout, volume.label.data(), volume.distance.data()),
                      "no/such/folder/x.vdb");
  } catch (const conceg::Error &error) {
    status = error.status();
  }
  CHECK_EQUAL(status, conceg::vdb_available() ? CONCEG_E_IO : CONCEG_E_UNSUPPORTED);
}

#ifdef CONCEG_HAS_OPENVDB

// Values of the arrays that differ from a grid's, and active voxels of the grid.
template <class Grid, class Values, class Active>
std::size_t differences(const Grid &grid, const Volume &volume, const Values &values, Active active) {
  auto read = grid.getConstAccessor();
  std::size_t wrong = 0;
  std::uint64_t wanted = 0;
  for (std::size_t i = 0; i < values.size(); i++) {
    const std::size_t voxel = i % kLeafVoxels;
    const glm::ivec3 at = volume.layout.leaf_origin[i / kLeafVoxels];
    const openvdb::Coord place(at.x + int(voxel / 64), at.y + int(voxel / 8 % 8), at.z + int(voxel % 8));
    wrong += read.getValue(place) != static_cast<typename Grid::ValueType>(values[i]);
    wrong += read.isValueOn(place) != active(values[i]);
    wanted += active(values[i]);
  }
  return wrong + (grid.activeVoxelCount() == wanted ? 0 : 1);
}

void openvdb_reads_it_back() {
  Volume volume = volume_of_tissue(forest(20, 2, 600, 3), step(0.4));
  const char *path = "test_mesh_volume.vdb";
  conceg::write_vdb(leaves(volume.layout, volume.label.data(), volume.distance.data()), path);
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  const auto label = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("label"));
  const auto distance = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("distance"));
  file.close();
  std::remove(path);
  const float band = static_cast<float>(volume.layout.band);
  const auto inside = [](std::uint32_t l) { return l != 0; };
  const auto near = [band](float d) { return std::fabs(d) < band; };
  CHECK_EQUAL(differences(*label, volume, volume.label, inside), 0);
  CHECK_EQUAL(differences(*distance, volume, volume.distance, near), 0);
  CHECK(distance->getGridClass() == openvdb::GRID_LEVEL_SET && distance->background() == band);
  CHECK(label->background() == 0);
  CHECK(label->tree().activeTileCount() > 0); // somas are tiles
  const openvdb::Vec3d corner = distance->indexToWorld(openvdb::Coord(3, 0, 49));
  const glm::dvec3 wanted = volume.layout.origin() + glm::dvec3(3, 0, 49) * volume.layout.spacing();
  CHECK_NEAR(corner.x(), wanted.x, 1e-12);
  CHECK_NEAR(corner.z(), wanted.z, 1e-12);
  CHECK_TEXT(label->metaValue<std::string>("length_unit").c_str(), "um");
  // Planted: one voxel that differs is seen.
  volume.label[volume.label.size() / 2 + 3] += 1;
  volume.distance[17] += 1e-4f;
  CHECK(differences(*label, volume, volume.label, inside) > 0);
  CHECK(differences(*distance, volume, volume.distance, near) > 0);
}

#else
void openvdb_reads_it_back() {}
#endif

} // namespace

int main() {
  ball_and_cone_have_their_distance();
  nearer_cell_wins();
  labels_fill_what_cells_fill();
  folder_that_is_not_there();
  openvdb_reads_it_back();
  return check_done();
}
