// SPDX-License-Identifier: BSD-3-Clause
// Blocks out of meshes whose inside is known, over the faces of the box, and what is measured in boxes that
// are not periodic.
#include "../blocks.hpp"
#include "../paths.hpp"
#include "../pore_space.hpp"
#include "../transport.hpp"
#include "check.h"
#include "conceg/rng.h"

#include <algorithm>
#include <cmath>

using namespace conceg;
using namespace conceg::analyse;

namespace {

conceg_box box_of(double side, bool periodic) {
  conceg_box box = {};
  for (int a = 0; a < 3; a++)
    box.hi[a] = side, box.periodic[a] = periodic;
  return box;
}

// Octahedra |x| + |y| + |z| < r.
Meshes octahedra(const std::vector<glm::dvec3> &centre, double r) {
  Meshes m;
  m.vertex_offset = m.face_offset = {0};
  for (std::uint32_t k = 0; k < centre.size(); k++) {
    m.cell.push_back(k);
    for (int a = 0; a < 3; a++)
      for (const double sign : {-1.0, 1.0}) {
        glm::dvec3 p = centre[k];
        p[a] += sign * r;
        m.vertex.push_back(p);
      }
    for (std::uint32_t n = 0; n < 8; n++) { // one of each pair; outward
      const std::uint32_t x = n & 1, y = 2 + (n >> 1 & 1), z = 4 + (n >> 2);
      const bool turned = (x + y + z) % 2 == 0;
      for (const std::uint32_t v : {x, turned ? z : y, turned ? y : z})
        m.face.push_back(v);
    }
    m.vertex_offset.push_back(m.vertex.size()), m.face_offset.push_back(m.face.size() / 3);
  }
  return m;
}

void voxels_are_right(bool periodic) {
  const conceg_box box = box_of(10, periodic);
  // Out of the box on all sides; a lattice of coordinates, so that rays meet edges and vertices.
  const std::vector<glm::dvec3> centre = {{0.5, 5, 5}, {5, 9.75, 0.25}, {15, 14.5, -4.75}, {3, 3, 9.5}};
  const Meshes meshes = octahedra(centre, 1.75);
  std::size_t inside = 0;
  for (const glm::dvec3 &lo : {glm::dvec3(7, 6.5, 8), glm::dvec3(0, 0, 0), glm::dvec3(9.125, 2, 3)}) {
    const Block block = {lo, 6};
    Workers workers(2);
    const OpenVoxels v = block_voxels(meshes, box, block, 24, workers);
    std::size_t wrong = 0, edge = 0;
    for (std::size_t i = 0; i < v.open.size(); i++) {
      const glm::dvec3 p = lo + 0.25 * (glm::dvec3(i / 576, i / 24 % 24, i % 24) + 0.5);
      double nearest = 100;
      for (const glm::dvec3 &c : centre) {
        double sum = 0;
        for (int a = 0; a < 3; a++) {
          const double d = p[a] - c[a];
          sum += std::abs(periodic ? d - 10 * std::round(d / 10) : d);
        }
        nearest = std::min(nearest, sum);
      }
      edge += nearest == 1.75; // on a face: either
      inside += nearest < 1.75;
      wrong += nearest != 1.75 && (nearest > 1.75) != (v.open[i] != 0);
    }
    CHECK_EQUAL(wrong, static_cast<std::size_t>(0));
    CHECK(edge < v.open.size() / 20);
    Workers three(3);
    CHECK(v.open == block_voxels(meshes, box, block, 24, three).open);
  }
  CHECK(inside > 200);
}

void places() {
  const conceg_box open = box_of(10, false), periodic = box_of(10, true);
  for (const Block &b : choose_blocks(open, 50, 4, 1))
    for (int a = 0; a < 3; a++)
      CHECK(b.lo[a] >= 0 && b.lo[a] + 4 <= 10);
  double most = 0;
  for (const Block &b : choose_blocks(periodic, 50, 4, 1))
    most = std::max(most, b.lo.x);
  CHECK(most > 6);
  CHECK(choose_blocks(open, 1, 4, 1)[0].lo != choose_blocks(open, 1, 4, 2)[0].lo);
  bool refused = false;
  try {
    choose_blocks(open, 1, 11, 1);
  } catch (const Error &e) {
    refused = e.status() == CONCEG_E_RANGE;
  }
  CHECK(refused);
}

// Random open voxels, and the same with its images in mirrors at the upper faces.
OpenVoxels random_voxels(std::array<std::size_t, 3> shape, double share) {
  OpenVoxels v = {shape, {}, {1, 1, 1}, {{false, false, false}}};
  conceg_rng rng = conceg_rng_stream(3, "test.blocks", 0);
  for (std::size_t i = 0; i < shape[0] * shape[1] * shape[2]; i++)
    v.open.push_back(conceg_rng_uniform(&rng) < share);
  return v;
}

// A block that is not periodic is the periodic one of its mirror images.
void transport_is_mirrored() {
  const OpenVoxels v = random_voxels({8, 10, 12}, 0.7);
  OpenVoxels mirrored = {{16, 20, 24}, {}, {1, 1, 1}};
  for (std::size_t x = 0; x < 16; x++)
    for (std::size_t y = 0; y < 20; y++)
      for (std::size_t z = 0; z < 24; z++)
        mirrored.open.push_back(
            v.open[(std::min(x, 15 - x) * 10 + std::min(y, 19 - y)) * 12 + std::min(z, 23 - z)]);
  Workers workers(2);
  const Transport a = transport_of(v, {true, true, true}, 1e-10, workers, {}),
                  b = transport_of(mirrored, {true, true, true}, 1e-10, workers, {});
  OpenVoxels wrapped = v;
  wrapped.periodic = {true, true, true};
  const Transport c = transport_of(wrapped, {true, true, true}, 1e-10, workers, {});
  for (std::size_t k = 0; k < 3; k++) {
    CHECK_NEAR(a.ratio[k], b.ratio[k], 1e-8);
    CHECK(std::abs(a.ratio[k] - c.ratio[k]) > 1e-4); // and not the periodic block itself
  }
  OpenVoxels empty = v;
  empty.open.assign(empty.open.size(), 1);
  CHECK_NEAR(transport_of(empty, {true, true, true}, 1e-10, workers, {}).lambda(), 1, 1e-9);
}

// One wall in the middle: distances, maxima and chords know nothing of images.
void pores_end_at_faces() {
  OpenVoxels v = {{41, 9, 1}, std::vector<std::uint8_t>(41 * 9, 1), {1, 1, 1}, {{false, false, false}}};
  for (std::size_t y = 0; y < 9; y++)
    v.open[20 * 9 + y] = 0;
  Workers workers(2);
  const std::vector<float> radius = pore_radii(v, workers);
  CHECK_NEAR(static_cast<double>(radius[0]), 19.5, 1e-6);
  CHECK_NEAR(static_cast<double>(radius[40 * 9]), 19.5, 1e-6);
  const PoreSpace open = pore_space({v}, workers);
  CHECK_EQUAL(open.centres.count, 0u); // both lie at faces
  CHECK_EQUAL(open.chords.count, 0u);
  CHECK_EQUAL(open.voxels.count, 0u);
  v.periodic = {true, true, true};
  const PoreSpace periodic = pore_space({v}, workers);
  CHECK_EQUAL(periodic.centres.count, 1u);
  CHECK_EQUAL(periodic.chords.count, 9u);
  CHECK_EQUAL(periodic.voxels.count, 40u * 9u);
}

void paths_end_at_faces() {
  OpenVoxels v = {{40, 20, 1}, std::vector<std::uint8_t>(800, 1), {1, 1, 1}, {{false, false, false}}};
  for (std::size_t y = 0; y < 20; y++)
    v.open[20 * 20 + y] = 0;
  CHECK(std::isinf(marched_lengths(v, 5)[39 * 20 + 5]) && std::isinf(stepped_lengths(v, 5, 26)[39 * 20 + 5]));
  CHECK_NEAR(static_cast<double>(marched_lengths(v, 0)[19 * 20 + 19]), 19 * std::sqrt(2.0), 0.3);
  CHECK_EQUAL(open_pieces(v).pieces, 2u);
  CHECK_NEAR(open_pieces(v).largest, 400.0 / 780, 1e-9);
  v.periodic = {true, true, true};
  CHECK_NEAR(static_cast<double>(marched_lengths(v, 5)[39 * 20 + 5]), 1, 1e-6);
  CHECK_EQUAL(open_pieces(v).pieces, 1u);
  PathSettings settings;
  settings.least = 10;
  Workers workers(2);
  v.periodic = {false, false, false};
  const PathStraightness found = path_straightness({v, v}, settings, workers, {});
  CHECK_EQUAL(found.pairs, 16u * 64u);
  CHECK(found.apart > 200 && found.apart < 900 && found.marched.mean > 0.99);
}

} // namespace

int main() {
  voxels_are_right(true);
  voxels_are_right(false);
  places();
  transport_is_mirrored();
  pores_end_at_faces();
  paths_end_at_faces();
  return check_done();
}
