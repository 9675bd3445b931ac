// SPDX-License-Identifier: BSD-3-Clause
// The extracellular surface: closed, of the box's volume less the cells', alike on opposite sides; and the
// triangulation of its sides.
#include "ball.hpp"
#include "check.h"
#include "conceg/rng.h"
#include "extracellular.hpp"
#include "guard.hpp"
#include "region.hpp"

#include <glm/geometric.hpp>

#include <cmath>
#include <map>
#include <set>

using namespace conceg;
using namespace conceg::exporting;

namespace {

Surface ball(const glm::dvec3 &centre, double radius, int rings = 17, int sectors = 23) {
  return testing::ball(centre, radius, rings, sectors);
}

double volume(const Surface &s) {
  double sum = 0;
  for (const glm::uvec3 &f : s.face)
    sum += glm::dot(s.vertex[f.x], glm::cross(s.vertex[f.y], s.vertex[f.z])) / 6;
  return sum;
}

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

// Triangles in a side by the places of their corners, seen from above.
using Triangles = std::multiset<std::set<std::pair<double, double>>>;
Triangles in_side(const Surface &s, const std::vector<std::uint8_t> &label, int axis, double value,
                  double &area) {
  Triangles out;
  area = 0;
  for (std::size_t i = 0; i < s.face.size(); i++) {
    const glm::dvec3 t[3] = {s.vertex[s.face[i].x], s.vertex[s.face[i].y], s.vertex[s.face[i].z]};
    if (label[i] != 0 || t[0][axis] != value || t[1][axis] != value || t[2][axis] != value) continue;
    std::set<std::pair<double, double>> corners;
    for (const glm::dvec3 &p : t)
      corners.insert({p[(axis + 1) % 3], p[(axis + 2) % 3]});
    out.insert(corners);
    const double part = 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    CHECK(part > 0);
    area += part;
  }
  return out;
}

conceg_box box_of(bool periodic) {
  return {{-3, 0, 1}, {7.25, 9.5, 12}, {periodic, periodic, periodic}};
}

void check_space(const conceg_box &box, const std::vector<Surface> &cells, double filled) {
  ExtracellularSurface space(box);
  for (const Surface &cell : cells)
    space.add(cell, {});
  space.close();
  const Surface &s = space.surface();
  const double whole = (box.hi[0] - box.lo[0]) * (box.hi[1] - box.lo[1]) * (box.hi[2] - box.lo[2]);
  CHECK(is_closed(s));
  CHECK_EQUAL(space.label().size(), s.face.size());
  CHECK_NEAR(volume(s), whole - filled, 1e-5 * whole);
  double all[6];
  for (int axis = 0; axis < 3; axis++) {
    const Triangles low = in_side(s, space.label(), axis, box.lo[axis], all[2 * axis]),
                    high = in_side(s, space.label(), axis, box.hi[axis], all[2 * axis + 1]);
    if (box.periodic[axis]) CHECK(low == high && !low.empty());
    for (const glm::dvec3 &p : s.vertex)
      if (!(p[axis] >= box.lo[axis] && p[axis] <= box.hi[axis])) CHECK(false);
  }
  for (std::size_t i = 0; i < s.face.size(); i++)
    if (space.label()[i] > 1) CHECK(false);
}

// Inside, through a side, an edge and a corner; alone and together; with all corners of the box in a cell.
void spaces_close() {
  const conceg_box box = box_of(true);
  const Surface inside = ball({2, 5, 6}, 1.5), side = ball({-2.9, 5, 9}, 1.2),
                edge = ball({7.1, 0.2, 6}, 1.4), corner = ball({-2.8, 9.3, 1.1}, 2.1);
  const auto sum = [](const std::vector<Surface> &cells) {
    double total = 0;
    for (const Surface &cell : cells)
      total += volume(cell);
    return total;
  };
  for (const std::vector<Surface> &cells :
       {std::vector<Surface>{}, {inside}, {side}, {edge}, {corner}, {inside, side, edge, corner}})
    check_space(box, cells, sum(cells));
  // A shell whose cavity is space, cut by a corner: sides with islands.
  Surface hollow = corner, cavity = ball({-2.7, 9.4, 1.3}, 1.2);
  for (glm::uvec3 &f : cavity.face)
    std::swap(f.y, f.z);
  append(hollow, cavity);
  check_space(box, {hollow, inside}, volume(hollow) + volume(inside));
  // Open sides are sides too: what lies beyond them is cut off.
  const conceg_box open = box_of(false);
  check_space(open, {inside}, volume(inside));
  const Surface middle = ball({7.25, 5, 6}, 1.0); // its middle lies in the side
  check_space(open, {middle}, volume(middle) / 2);
}

// Random balls at random places, those that come too near left out.
void many_cells() {
  const conceg_box box = box_of(true);
  conceg_rng rng = conceg_rng_stream(3, "test.space", 0);
  std::vector<Surface> cells;
  std::vector<glm::dvec3> centres;
  std::vector<double> radii;
  double filled = 0;
  for (int trial = 0; trial < 400; trial++) {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; axis++)
      p[axis] = box.lo[axis] + conceg_rng_uniform(&rng) * (box.hi[axis] - box.lo[axis]);
    const double r = 0.2 + conceg_rng_uniform(&rng);
    bool free = true;
    for (std::size_t i = 0; free && i < centres.size(); i++) {
      glm::dvec3 d;
      for (int axis = 0; axis < 3; axis++)
        d[axis] = conceg_box_nearest(&box, axis, p[axis] - centres[i][axis]);
      free = glm::length(d) > r + radii[i] + 0.02;
    }
    if (!free) continue;
    cells.push_back(ball(p, r, 9, 11)), centres.push_back(p), radii.push_back(r);
    filled += volume(cells.back());
  }
  CHECK(cells.size() > 60);
  check_space(box, cells, filled);
}

// The sum of the triangles' areas is the region's, all run anticlockwise, and there are n - 2 + 2 holes of
// them for each outline.
void regions() {
  conceg_rng rng = conceg_rng_stream(5, "test.region", 0);
  for (int round = 0; round < 200; round++) {
    std::vector<PlanePoint> point;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edge;
    __int128 twice = 0;
    std::size_t expected = 0;
    const auto add = [&](std::int64_t u, std::int64_t v, std::int64_t size, int corners, bool hole) {
      const auto first = static_cast<std::uint32_t>(point.size());
      for (int i = 0; i < corners; i++) { // a star with many points of equal v
        const double angle = 6.283185307 * i / corners,
                     r = static_cast<double>(size) * (0.3 + 0.7 * conceg_rng_uniform(&rng));
        point.push_back({u + static_cast<std::int64_t>(r * std::cos(angle)) / 8 * 8,
                         v + static_cast<std::int64_t>(r * std::sin(angle)) / 64 * 64});
      }
      for (int i = 0; i < corners; i++) {
        const auto a = first + static_cast<std::uint32_t>(i),
                   b = first + static_cast<std::uint32_t>((i + 1) % corners);
        edge.emplace_back(hole ? b : a, hole ? a : b);
        const __int128 part = __int128(point[a].u) * point[b].v - __int128(point[a].v) * point[b].u;
        twice += hole ? -part : part;
      }
      expected += static_cast<std::size_t>(hole ? corners + 2 : corners - 2);
    };
    // A square with points on its border, holes and islands in a lattice.
    const std::int64_t side = 40000;
    std::vector<PlanePoint> border;
    for (std::int64_t k = 0; k < side; k += 4000)
      border.push_back({k, 0});
    for (std::int64_t k = 0; k < side; k += 5000)
      border.push_back({side, k});
    for (std::int64_t k = side; k > 0; k -= 8000)
      border.push_back({k, side});
    for (std::int64_t k = side; k > 0; k -= 10000)
      border.push_back({0, k});
    for (std::size_t i = 0; i < border.size(); i++) {
      point.push_back(border[i]);
      edge.emplace_back(i, (i + 1) % border.size());
    }
    twice += 2 * __int128(side) * side, expected += border.size() - 2;
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++) {
        if (conceg_rng_uniform(&rng) < 0.2) continue;
        add(5000 + 10000 * i, 5000 + 10000 * j, 4900, 9 + 3 * j, true);
        if (conceg_rng_uniform(&rng) < 0.5) add(5000 + 10000 * i, 5000 + 10000 * j, 1000, 9, false);
      }
    __int128 covered = 0;
    std::size_t triangles = 0;
    const std::int64_t bad =
        triangulate_region(point, edge, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
          const __int128 area = __int128(point[b].u - point[a].u) * (point[c].v - point[a].v) -
                                __int128(point[b].v - point[a].v) * (point[c].u - point[a].u);
          if (!(area > 0)) CHECK(false);
          covered += area, triangles++;
        });
    CHECK_EQUAL(bad, -1);
    CHECK(covered == twice);
    CHECK_EQUAL(triangles, expected);
  }
  // What is no region is refused.
  const auto refused = [](const std::vector<PlanePoint> &point,
                          const std::vector<std::pair<std::uint32_t, std::uint32_t>> &edge) {
    return triangulate_region(point, edge, [](auto, auto, auto) {}) >= 0;
  };
  CHECK(refused({{0, 0}, {10, 0}, {5, 5}}, {{0, 1}, {1, 2}}));                         // open
  CHECK(refused({{0, 0}, {10, 0}, {5, 5}}, {{0, 2}, {2, 1}, {1, 0}}));                 // the wrong way round
  CHECK(refused({{0, 0}, {10, 0}, {5, 5}, {5, 5}}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}})); // two at one place
}

void refused_where_it_must() {
  Surface torn = ball({-2.9, 5, 6}, 2.3);
  torn.face.erase(torn.face.begin() + 200, torn.face.begin() + 240);
  ExtracellularSurface space(box_of(true));
  space.add(torn, {});
  conceg_status status = CONCEG_OK;
  try {
    space.close();
  } catch (const Error &error) {
    status = error.status();
  }
  CHECK_EQUAL(status, CONCEG_E_UNSUPPORTED);
}

} // namespace

int main() {
  regions();
  spaces_close();
  many_cells();
  refused_where_it_must();
  return check_done();
}
