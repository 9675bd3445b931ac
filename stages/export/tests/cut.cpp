// SPDX-License-Identifier: BSD-3-Clause
// A surface cut at the box: its rims on opposite sides are the same to the last bit, and nothing is lost.
#include "cut.hpp"
#include "ball.hpp"
#include "check.h"
#include "guard.hpp"

#include <glm/geometric.hpp>

#include <cmath>
#include <map>
#include <set>
#include <tuple>

using namespace conceg;
using namespace conceg::exporting;

namespace {

// An uneven one.
Surface ball(const glm::dvec3 &centre, double radius) {
  return testing::ball(centre, radius, 23, 31, 0.05);
}

double area(const Surface &s) {
  double sum = 0;
  for (const glm::uvec3 &f : s.face)
    sum += 0.5 * glm::length(glm::cross(s.vertex[f.y] - s.vertex[f.x], s.vertex[f.z] - s.vertex[f.x]));
  return sum;
}

using Point = std::tuple<double, double>;
using Rim = std::multiset<std::pair<Point, Point>>;

// Edges with one face that lie in the plane, by their other two coordinates.
Rim rim(const Surface &s, int axis, double value) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> faces;
  for (const glm::uvec3 &f : s.face)
    for (int k = 0; k < 3; k++)
      faces[std::minmax(f[k], f[(k + 1) % 3])]++;
  Rim out;
  for (const auto &[edge, count] : faces) {
    const glm::dvec3 &a = s.vertex[edge.first], &b = s.vertex[edge.second];
    if (count != 1 || a[axis] != value || b[axis] != value) continue;
    const auto flat = [&](const glm::dvec3 &p) { return Point(p[(axis + 1) % 3], p[(axis + 2) % 3]); };
    out.insert(std::minmax(flat(a), flat(b)));
  }
  return out;
}

// At the middle of a side, at an edge and at a corner of the box.
void rims_are_bit_equal() {
  const conceg_box box = {{-3, 0, 1}, {7.25, 9.5, 12}, {1, 1, 1}};
  for (const glm::dvec3 &centre :
       {glm::dvec3(-2.9, 5, 6), glm::dvec3(7.1, 0.2, 6), glm::dvec3(-2.8, 9.3, 1.1)}) {
    const Surface whole = ball(centre, 2.3), cut = cut_at_box(box, whole);
    CHECK_NEAR(area(cut), area(whole), 1e-5 * area(whole));
    std::size_t edges = 0;
    for (int axis = 0; axis < 3; axis++) {
      const Rim low = rim(cut, axis, box.lo[axis]), high = rim(cut, axis, box.hi[axis]);
      CHECK(low == high);
      edges += low.size();
    }
    CHECK(edges > 40);
  }
}

double volume(const Surface &s) {
  double sum = 0;
  for (const glm::uvec3 &f : s.face)
    sum += glm::dot(s.vertex[f.x], glm::cross(s.vertex[f.y], s.vertex[f.z])) / 6;
  return sum;
}

// Every edge has two faces that run along it in opposite directions.
bool is_closed(const Surface &s) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const glm::uvec3 &f : s.face)
    for (int k = 0; k < 3; k++)
      edges[{f[k], f[(k + 1) % 3]}]++;
  for (const auto &[edge, count] : edges) {
    const auto other = edges.find({edge.second, edge.first});
    if (count != 1 || other == edges.end() || other->second != 1) return false;
  }
  return true;
}

// Corners and area of the faces that lie in a side.
std::set<Point> lid(const Surface &s, int axis, double value, double &sum) {
  std::set<Point> corners;
  for (const glm::uvec3 &f : s.face) {
    const glm::dvec3 t[3] = {s.vertex[f.x], s.vertex[f.y], s.vertex[f.z]};
    if (t[0][axis] != value || t[1][axis] != value || t[2][axis] != value) continue;
    for (const glm::dvec3 &p : t)
      corners.insert({p[(axis + 1) % 3], p[(axis + 2) % 3]});
    const double area = 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    CHECK(area > 0);
    sum += area;
  }
  return corners;
}

// A ball, and a thick shell, whose lids have holes.
void capped_pieces_are_closed() {
  const conceg_box box = {{-3, 0, 1}, {7.25, 9.5, 12}, {1, 1, 1}};
  for (const bool hollow : {false, true})
    for (const glm::dvec3 &centre :
         {glm::dvec3(-2.9, 5, 6), glm::dvec3(7.1, 0.2, 6), glm::dvec3(-2.8, 9.3, 1.1)}) {
      Surface whole = ball(centre, 2.3);
      if (hollow) {
        Surface inner = ball(centre + glm::dvec3(0.1, 0.2, 0), 1.4);
        for (glm::uvec3 &f : inner.face)
          std::swap(f.x, f.y);
        append(whole, inner);
      }
      const CutSurface capped = capped_at_box(box, whole);
      CHECK(is_closed(capped));
      CHECK_EQUAL(capped.source_face.size(), capped.face.size());
      CHECK_NEAR(volume(capped), volume(whole), 1e-5 * volume(whole));
      double lids = 0;
      for (int axis = 0; axis < 3; axis++) {
        double low = 0, high = 0;
        CHECK(lid(capped, axis, box.lo[axis], low) == lid(capped, axis, box.hi[axis], high));
        CHECK_NEAR(low, high, 1e-9);
        lids += low;
        for (const glm::dvec3 &p : capped.vertex)
          if (!(p[axis] >= box.lo[axis] && p[axis] <= box.hi[axis])) CHECK(false);
      }
      CHECK(lids > 5);
      // All that is not a lid is what an open cut leaves.
      CHECK_NEAR(area(capped) - 2 * lids, area(cut_at_box(box, whole)), 1e-5 * area(whole));
    }
  // An open surface cannot be closed by lids: said, not guessed.
  Surface torn = ball({-2.9, 5, 6}, 2.3);
  torn.face.erase(torn.face.begin() + 600, torn.face.begin() + 700);
  bool refused = false;
  try {
    capped_at_box(box, torn);
  } catch (const Error &error) {
    refused = error.status() == CONCEG_E_UNSUPPORTED;
  }
  CHECK(refused);
}

} // namespace

int main() {
  rims_are_bit_equal();
  capped_pieces_are_closed();
  return check_done();
}
