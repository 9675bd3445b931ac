// SPDX-License-Identifier: BSD-3-Clause
// The check finds what it must: each defect is planted in a sound mesh and must be named, and nothing else.
#include "check.h"
#include "check.hpp"
#include "scenes.hpp"

using namespace scenes;

namespace {

const conceg_box periodic = {{0, 0, 0}, {10, 10, 10}, {1, 1, 1}};

CheckResult judge(const std::vector<Surface> &surfaces, unsigned threads = 2) {
  conceg::Workers workers(threads);
  return check_surfaces(views_of(surfaces), periodic, {}, workers, {});
}

bool finds(const std::vector<Surface> &surfaces, Flaw flaw) {
  for (const Defect &defect : judge(surfaces).defects)
    if (defect.flaw == flaw) return !describe(defect, views_of(surfaces)).empty();
  return false;
}

Surface ball(const glm::dvec3 &centre, double radius, std::uint32_t cell) {
  Tissue tissue = empty_box(10);
  add_cell(tissue, centre, radius);
  SceneOptions options;
  options.h = 0.4;
  Surface surface = mesh_of(tissue, options).surfaces[0];
  surface.cell = cell;
  return surface;
}

// Two tetrahedra-like fans of plain coordinates for exact cases.
Surface tetrahedron(const glm::vec3 &at, float size, std::uint32_t cell) {
  Surface s;
  s.cell = cell;
  s.vertex = {at, at + glm::vec3(size, 0, 0), at + glm::vec3(0, size, 0), at + glm::vec3(0, 0, size)};
  s.face = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return s;
}

void sound_meshes_pass() {
  const std::vector<Surface> two = {ball({3, 3, 3}, 1.5, 0), ball({7, 7, 7}, 1.5, 1)};
  const CheckResult result = judge(two);
  CHECK_EQUAL(result.defects.size(), 0);
  CHECK(result.closed[0] && result.closed[1]);
  CHECK(result.pairs_checked > two[0].face.size());
  CHECK_NEAR(result.min_gap[0], 0.09, 1e-12); // farther than what is measured
  CHECK_EQUAL(judge({tetrahedron({1, 1, 1}, 1, 0)}).defects.size(), 0);
}

void crossings_are_found() {
  std::vector<Surface> two = {ball({3, 3, 3}, 1.5, 0), ball({7, 7, 7}, 1.5, 1)};
  two[1].origin = {5.5, 3, 3};
  CHECK(finds(two, Flaw::crossing_cells));
  const CheckResult result = judge(two);
  CHECK(result.crossings == result.defects.size() && result.errors == result.crossings);
  CHECK_NEAR(result.min_gap[0], 0, 0);
  // Across a face of the box, one and three boxes away.
  for (const double far : {10.5, 30.5}) {
    two[0].origin = {0.5, 3, 3}, two[1].origin = {far - 2.0, 3, 3};
    CHECK(finds(two, Flaw::crossing_cells));
  }
  // A ball wider than the box crosses its own images, and only those.
  const std::vector<Surface> wide = {ball({5, 5, 5}, 4.9, 0)};
  CHECK_EQUAL(judge(wide).defects.size(), 0);
  std::vector<Surface> wider = wide;
  for (glm::vec3 &v : wider[0].vertex)
    v *= 1.05f;
  CHECK(finds(wider, Flaw::crossing_image));
  CHECK(!finds(wider, Flaw::crossing_cells) && !finds(wider, Flaw::crossing_self));
}

void touching_is_a_crossing() {
  // Corner on a face, and corner on corner: distance 0.
  std::vector<Surface> two = {tetrahedron({1, 1, 1}, 1, 0), tetrahedron({2, 1, 1}, 1, 1)};
  CHECK(finds(two, Flaw::crossing_cells));
  two[1] = tetrahedron({2.03125f, 1, 1}, 1, 1);
  CHECK_EQUAL(judge(two).defects.size(), 0);
  CHECK_NEAR(judge(two).min_gap[0], 0.03125, 1e-9);
  conceg::Workers workers(1);
  CheckOptions options;
  options.least_gap = 0.035;
  const CheckResult result = check_surfaces(views_of(two), periodic, options, workers, {});
  CHECK(!result.defects.empty() && result.defects[0].flaw == Flaw::near && result.errors == 0 &&
        result.crossings == 0);
}

void self_crossings_and_folds_are_found() {
  Surface s = ball({5, 5, 5}, 2, 0);
  std::vector<Surface> one = {s};
  one[0].vertex[0] = -1.5f * one[0].vertex[0]; // pulled through the other side
  CHECK(finds(one, Flaw::crossing_self));
  // A fold: a vertex moved past its neighbour, so that faces around it overlap.
  one[0] = s;
  const glm::uvec3 f = s.face[0];
  one[0].vertex[f.x] = s.vertex[f.x] + 2.5f * (s.vertex[f.y] - s.vertex[f.x]);
  CHECK(finds(one, Flaw::fold) || finds(one, Flaw::crossing_self));
  // A flat flap: the apex of one face of a tetrahedron laid onto the face beside it.
  Surface flap;
  flap.vertex = {{1, 1, 1}, {3, 1, 1}, {1, 3, 1}, {1.5f, 1.5f, 1}};
  flap.face = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  CHECK(finds({flap}, Flaw::fold));
}

void broken_topology_is_found() {
  const Surface s = ball({5, 5, 5}, 2, 0);
  std::vector<Surface> one = {s};
  one[0].face.pop_back();
  CHECK(finds(one, Flaw::open_edge) && !judge(one).closed[0]);
  one[0] = s;
  std::swap(one[0].face[3].x, one[0].face[3].y);
  CHECK(finds(one, Flaw::turned_face));
  one[0] = s;
  for (glm::uvec3 &f : one[0].face)
    std::swap(f.x, f.y);
  CHECK(finds(one, Flaw::inward));
  one[0] = s;
  one[0].face.push_back(one[0].face[0]);
  CHECK(finds(one, Flaw::turned_face));
  one[0] = s;
  one[0].face[5].z = one[0].face[5].y;
  CHECK(finds(one, Flaw::degenerate_face));
  one[0] = s;
  one[0].face[5].z = 1u << 30;
  CHECK(finds(one, Flaw::bad_index));
  one[0] = s;
  one[0].vertex.push_back({9, 9, 9});
  CHECK(finds(one, Flaw::unused_vertex));
  // Two tetrahedra joined at one vertex: every edge is sound, the vertex is not.
  Surface joined = tetrahedron({1, 1, 1}, 1, 0);
  joined.vertex.insert(joined.vertex.end(), {{0, 1, 1}, {1, 0, 1}, {1, 1, 0}});
  joined.face.insert(joined.face.end(), {{0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}});
  CHECK(finds({joined}, Flaw::split_vertex));
  // The same with the common vertex twice: topology is sound, but the surface touches itself.
  joined.vertex.push_back(joined.vertex[0]);
  for (std::size_t f = 4; f < 8; f++)
    for (int k = 0; k < 3; k++)
      if (joined.face[f][k] == 0) joined.face[f][k] = 7;
  CHECK(!finds({joined}, Flaw::split_vertex) && finds({joined}, Flaw::crossing_self));
  // Three points on a line.
  Surface line = tetrahedron({1, 1, 1}, 1, 0);
  line.vertex[3] = {1, 1.5f, 1};
  CHECK(finds({line}, Flaw::degenerate_face));
}

void threads_agree() {
  std::vector<Surface> many;
  for (std::uint32_t i = 0; i < 6; i++)
    many.push_back(ball({1.7 * i, 5, 5}, 1.2, i));
  const CheckResult one = judge(many, 1), three = judge(many, 3);
  CHECK(one.crossings > 10);
  CHECK_EQUAL(one.crossings, three.crossings);
  CHECK_EQUAL(one.pairs_checked, three.pairs_checked);
  for (std::size_t i = 0; i < one.defects.size(); i++)
    CHECK(one.defects[i].flaw == three.defects[i].flaw && one.defects[i].face == three.defects[i].face &&
          one.defects[i].other_face == three.defects[i].other_face &&
          one.defects[i].lift == three.defects[i].lift);
}

} // namespace

int main() {
  sound_meshes_pass();
  crossings_are_found();
  touching_is_a_crossing();
  self_crossings_and_folds_are_found();
  broken_topology_is_found();
  threads_agree();
  return check_done();
}
