// SPDX-License-Identifier: BSD-3-Clause
// Volumes, areas and volume fractions of shapes with known sizes.
#include "../tables.hpp"
#include "check.h"
#include "shapes.hpp"

#include <cmath>
#include <cstring>
#include <string>

using namespace conceg;
using namespace conceg::analyse;
using namespace shapes;

namespace {

constexpr double pi = 3.14159265358979323846;

template <class Body> std::string failure(Body body) {
  try {
    body();
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

bool says(const std::string &line, const char *part) {
  if (line.find(part) != std::string::npos) return true;
  fprintf(stderr, "got: %s\n", line.c_str());
  return false;
}

void sizes_of_shapes() {
  Meshes m;
  add_surface(m, 0, icosphere(5), 2, {9, 1, 5}); // across two faces of the box
  add_surface(m, 0, cylinder(0.5, 6, 256), 1, {5, 5, 7});
  Workers workers(2);
  const std::vector<Size> sizes = surface_sizes(m, box_of(10), workers);
  CHECK_NEAR(sizes[0].volume, 4.0 / 3 * pi * 8, 0.03);
  CHECK_NEAR(sizes[0].area, 4 * pi * 4, 0.05);
  CHECK_NEAR(sizes[1].volume, pi * 0.25 * 6, 0.001);
  CHECK_NEAR(sizes[1].area, pi * 6 + 2 * pi * 0.25, 0.002);
  // An open box keeps what is inside: half of a sphere on a face, an eighth of one on the corner, half of the
  // cylinder.
  Meshes open;
  add_surface(open, 0, icosphere(5), 2, {10, 5, 5});
  add_surface(open, 0, icosphere(5), 2, {0, 10, 0});
  add_surface(open, 0, cylinder(0.5, 6, 256), 1, {5, 5, 7});
  add_surface(open, 0, icosphere(3), 2, {20, 5, 5});
  const std::vector<Size> cut = surface_sizes(open, box_of(10, false), workers);
  CHECK_NEAR(cut[0].volume, 2.0 / 3 * pi * 8, 0.03);
  CHECK_NEAR(cut[0].area, 2 * pi * 4, 0.05);
  CHECK_NEAR(cut[1].volume, pi * 8 / 6, 0.03);
  CHECK_NEAR(cut[2].volume, pi * 0.25 * 3, 0.001);
  CHECK_NEAR(cut[2].area, pi * 3 + pi * 0.25, 0.002);
  CHECK_NEAR(cut[3].volume, 0, 1e-9);
  conceg_box mixed = box_of(10);
  mixed.periodic[2] = 0;
  CHECK_NEAR(surface_sizes(open, mixed, workers)[1].volume, 2.0 / 3 * pi * 8, 0.03);
}

void inside_out_is_named() {
  Meshes m;
  add_surface(m, 0, icosphere(1), 1, {5, 5, 5});
  add_surface(m, 3, icosphere(1), 1, {2, 2, 2});
  for (std::size_t f = m.face_offset[1]; f < m.face_offset[2]; f++)
    std::swap(m.face[3 * f], m.face[3 * f + 1]);
  Workers workers(1);
  CHECK(says(failure([&] { surface_sizes(m, box_of(10), workers); }),
             "surface 1 (cell 3): expected faces that point outward"));
}

void field_of_a_ball_and_a_capsule() {
  Cells cells;
  add_cell(cells, {0.5, 5, 5}, 2); // through a face
  add_cell(cells, {5, 5, 5}, 0);
  Skeletons skeletons;
  add_tree(skeletons, {}, {}, 1, 3);
  add_tree(skeletons, {{5, 2, 5}, {5, 8, 5}}, {-1, 0}, 0.5f, 3);
  Workers workers(2);
  const FieldShares f = field_shares(cells, skeletons, box_of(10), 0.05, workers, {});
  CHECK_EQUAL(f.voxels, 8000000);
  CHECK_NEAR(f.soma, 4.0 / 3 * pi * 8 / 1000, 1e-4);
  CHECK_NEAR(f.neurite, (pi * 0.25 * 6 + 4.0 / 3 * pi * 0.125) / 1000, 5e-5);
  // Open: the part beyond the face is gone. The cap lost: h = 1.5.
  const FieldShares open = field_shares(cells, skeletons, box_of(10, false), 0.05, workers, {});
  CHECK_NEAR(open.soma, (4.0 / 3 * pi * 8 - pi * 1.5 * 1.5 * (6 - 1.5) / 3) / 1000, 1e-4);
  Workers alone(1), three(3);
  const FieldShares one = field_shares(cells, skeletons, box_of(10), 0.1, alone, {}),
                    many = field_shares(cells, skeletons, box_of(10), 0.1, three, {});
  CHECK(one.soma == many.soma && one.neurite == many.neurite);
}

// A ball through a face and a rod of another cell, as labels: the shares are those of the shapes.
void labels_of_a_ball_and_a_rod() {
  Cells cells;
  add_cell(cells, {0.5, 5, 5}, 2);
  add_cell(cells, {5, 5, 5}, 0);
  const int side = 100; // not a multiple of 8: the last leaves reach beyond the box
  std::vector<std::int32_t> leaf;
  std::vector<std::uint32_t> label;
  std::size_t rod = 0;
  for (int x = 0; x < side; x += 8)
    for (int y = 0; y < side; y += 8)
      for (int z = 0; z < side; z += 8) {
        leaf.insert(leaf.end(), {x, y, z});
        for (int voxel = 0; voxel < 512; voxel++) {
          const glm::ivec3 at(x + voxel / 64, y + voxel / 8 % 8, z + voxel % 8);
          const glm::dvec3 p = (glm::dvec3(at) + 0.5) * 0.1;
          glm::dvec3 from = p - glm::dvec3(0.5, 5, 5);
          from.x -= 10 * std::round(from.x / 10);
          const bool in_rod = std::abs(p.x - 5) < 0.5 && std::abs(p.z - 5) < 0.5 &&
                              at.y<side, branch = from.x> 1.9 && from.x < 3 && std::abs(from.y) < 0.5 &&
                              std::abs(from.z) < 0.5;
          const bool beyond = at.x >= side || at.y >= side || at.z >= side;
          label.push_back(beyond ? 0 : glm::length(from) < 2 || branch ? 1 : in_rod ? 2 : 0);
          rod += label.back() == 2 || (label.back() == 1 && glm::length(from) >= 2);
        }
      }
  LabelVolume volume = {glm::dvec3(0.05), glm::dvec3(0.1), {100, 100, 100},
                        leaf.size() / 3,  leaf.data(),     label.data()};
  const conceg_box box = box_of(10);
  check(volume, cells, box);
  Workers one(1), three(3);
  const FieldShares shares = label_shares(volume, cells, box, one),
                    again = label_shares(volume, cells, box, three);
  CHECK_EQUAL(shares.voxels, 1000000);
  CHECK_NEAR(shares.soma, 4.0 / 3 * pi * 8 / 1000, 2e-4);
  CHECK_NEAR(shares.neurite, double(rod) / 1e6, 1e-15);
  CHECK(rod > 10000 && again.soma == shares.soma && again.neurite == shares.neurite);
  label[5] = 3;
  CHECK(says(failure([&] { check(volume, cells, box); }), "/volumes/label[0]: expected at most 2, got 3"));
  label[5] = 0, leaf[4] = 104;
  CHECK(says(failure([&] { check(volume, cells, box); }), "/volumes/leaf_origin[1]"));
  leaf[4] = 0, volume.shape[1] = 90;
  CHECK(says(failure([&] { check(volume, cells, box); }), "/volumes@shape[1]"));
}

// Plates of cells with clefts of 0.3 um between them, on voxels wider than that; and a leaf that is left out.
void clefts_between_plates() {
  Cells cells;
  add_cell(cells, {5, 5, 5}, 0);
  const double pitch = 1.25 * 1.6180339887, width = 0.3, step = 10.0 / 64, band = 0.31;
  std::vector<std::int32_t> leaf;
  std::vector<std::uint32_t> label;
  std::vector<float> distance;
  for (int x = 0; x < 64; x += 8)
    for (int y = 0; y < 64; y += 8)
      for (int z = 0; z < 64; z += 8) {
        leaf.insert(leaf.end(), {x, y, z});
        for (int voxel = 0; voxel < 512; voxel++) {
          const glm::dvec3 p = (glm::dvec3(x + voxel / 64, y + voxel / 8 % 8, z + voxel % 8) + 0.5) * step;
          const double along = p.x + 0.31 * p.y + 0.47 * p.z,
                       slope = std::sqrt(1 + 0.31 * 0.31 + 0.47 * 0.47),
                       place = along / slope - pitch * std::floor(along / slope / pitch); // 0 .. pitch
          const double d = std::min(place, width - place); // above 0 in the cleft
          label.push_back(d > 0 ? 0 : 1);
          distance.push_back(static_cast<float>(std::max(-band, std::min(band, d))));
        }
      }
  Workers one(1), three(3);
  LabelVolume volume = {glm::dvec3(0.5 * step), glm::dvec3(step), {64, 64, 64},
                        leaf.size() / 3,        leaf.data(),      label.data()};
  check(volume, cells, box_of(10));
  const Pores pores = pore_sizes(volume, distance.data(), one),
              again = pore_sizes(volume, distance.data(), three);
  CHECK_NEAR(double(pores.voxels) / 262144, width / pitch, 0.01);
  CHECK_NEAR(pores.cleft_width(), width, 0.003);
  CHECK_NEAR(pores.median, width / 4, 0.002);
  CHECK_NEAR(pores.p95, 0.475 * width, 0.002);
  CHECK(pores.mean == again.mean && pores.p95 == again.p95);
  // Without its last leaf, whose voxels now count as the band.
  volume.leaves--;
  distance[0] = static_cast<float>(band), label[0] = 0;
  const Pores less = pore_sizes(volume, distance.data(), one);
  CHECK_NEAR(less.beyond * double(less.voxels), 513, 1e-6);
}

void three_measures_agree() {
  Cells cells;
  Meshes meshes;
  Skeletons skeletons;
  const double size = 12;
  const Triangles ball = icosphere(5);
  int n = 0;
  for (int x = 0; x < 3; x++)
    for (int y = 0; y < 3; y++)
      for (int z = 0; z < 3; z++, n++) {
        // Unwrapped far from the box on purpose: images count, not the place.
        const glm::dvec3 at =
            glm::dvec3(4 * x + 0.3 * z, 4 * y, 4 * z) + size * glm::dvec3(n % 3 - 1, n % 4 - 2, n % 5);
        add_cell(cells, at, 1.7f);
        add_surface(meshes, static_cast<std::uint32_t>(n), ball, 1.7, at);
        add_tree(skeletons, {}, {}, 1, 3);
      }
  const conceg_box box = box_of(size);
  Measures m;
  m.box_volume = size * size * size;
  Workers workers(2);
  m.sizes = surface_sizes(meshes, box, workers);
  m.field = field_shares(cells, skeletons, box, 0.07, workers, {});
  m.points = locate_points(meshes, box, 200000, 1, workers, {});
  const double truth = 27 * 4.0 / 3 * pi * 1.7 * 1.7 * 1.7 / m.box_volume;
  printf("truth %.5f mesh %.5f field %.5f points %.5f +- %.5f\n", truth, mesh_fraction(m), m.field.soma,
         m.points.inside, m.points.standard_error);
  CHECK_NEAR(mesh_fraction(m), truth, 0.001);
  CHECK_NEAR(m.field.soma, truth, 0.001);
  CHECK_NEAR(m.points.inside, mesh_fraction(m), 4 * m.points.standard_error);
  CHECK(largest_difference(m) < 0.005);
  CHECK_EQUAL(m.points.in_several, 0);
  CHECK(m.points.standard_error > 0.0005 && m.points.standard_error < 0.0015);
  for (unsigned threads = 1; threads <= 3; threads++) {
    Workers w(threads);
    CHECK(locate_points(meshes, box, 50000, 1, w, {}).inside ==
          locate_points(meshes, box, 50000, 1, workers, {}).inside);
  }
  CHECK(locate_points(meshes, box, 50000, 2, workers, {}).inside !=
        locate_points(meshes, box, 50000, 1, workers, {}).inside);
  // Planted: a cell put on top of another one is seen by the points.
  add_surface(meshes, 0, ball, 1.0, cells.soma[5] + glm::dvec3(12, 0, 0));
  CHECK(locate_points(meshes, box, 50000, 1, workers, {}).in_several > 10);
}

void points_in_an_open_box() {
  Meshes meshes;
  add_surface(meshes, 0, icosphere(4), 3, {0, 5, 10});
  conceg_box box = box_of(10, false);
  Workers workers(2);
  const double quarter = 4.0 / 3 * pi * 27 / 4 / 1000;
  CHECK_NEAR(locate_points(meshes, box, 100000, 1, workers, {}).inside, quarter, 0.003);
  box.periodic[0] = 1;
  CHECK_NEAR(locate_points(meshes, box, 100000, 1, workers, {}).inside, 2 * quarter, 0.004);
}

void bad_arrays_are_named() {
  Cells cells;
  add_cell(cells, {1, 1, 1}, 1);
  Meshes m;
  add_surface(m, 0, icosphere(0), 1, {5, 5, 5});
  const Meshes good = m;
  m.face[7] = 12;
  CHECK(says(failure([&] { check(m, cells); }), "/meshes/face[2]"));
  m = good, m.cell[0] = 1;
  CHECK(says(failure([&] { check(m, cells); }), "/meshes/cell[0]"));
  m = good, m.face_offset[1] = 99;
  CHECK(says(failure([&] { check(m, cells); }), "/meshes/face_offset"));
  m = good, m.vertex[3].x = NAN;
  CHECK(says(failure([&] { check(m, cells); }), "/meshes/vertex[3]"));
  Skeletons s;
  add_tree(s, {{1, 1, 2}, {1, 1, 3}}, {-1, 0}, 0.5f, 3);
  s.radius[1] = 0;
  CHECK(says(failure([&] { check(s, cells); }), "/skeleton/radius[1]"));
  s.radius[1] = 1, s.parent[1] = 1;
  CHECK(says(failure([&] { check(s, cells); }), "/skeleton/parent[1]"));
  cells.type[0] = 9;
  CHECK(says(failure([&] { check(cells); }), "/cells/type[0]"));
  CHECK(failure([&] { check(good, Cells{}); }).size() > 0);
}

} // namespace

int main() {
  sizes_of_shapes();
  inside_out_is_named();
  field_of_a_ball_and_a_capsule();
  labels_of_a_ball_and_a_rod();
  clefts_between_plates();
  three_measures_agree();
  points_in_an_open_box();
  bad_arrays_are_named();
  return check_done();
}
