// SPDX-License-Identifier: GPL-3.0-or-later
// The network's edges: equal to CGAL's own periodic triangulation, and the same for any tiles, threads and
// translation.
#include "../circumsphere.hpp"
#include "../delaunay.hpp"
#include "../nodes.hpp"

#include "check.h"
#include "wrap.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Periodic_3_Delaunay_triangulation_3.h>
#include <CGAL/Periodic_3_Delaunay_triangulation_traits_3.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

using namespace conceg;
using namespace conceg::triangulate;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// A directed edge: from, to, shift.
using Edge = std::array<std::int64_t, 5>;

struct Network {
  std::vector<std::uint64_t> offset;
  std::vector<std::uint32_t> neighbour;
  std::vector<std::int8_t> shift;
  bool operator==(const Network &o) const {
    return offset == o.offset && neighbour == o.neighbour && shift == o.shift;
  }
  std::set<Edge> edges() const {
    std::set<Edge> out;
    for (std::size_t i = 0; i + 1 < offset.size(); i++)
      for (std::uint64_t k = offset[i]; k < offset[i + 1]; k++)
        out.insert(
            {static_cast<std::int64_t>(i), neighbour[k], shift[3 * k], shift[3 * k + 1], shift[3 * k + 2]});
    return out;
  }
};

static conceg_box cube(double side, bool periodic = true) {
  conceg_box box = {};
  for (int axis = 0; axis < 3; axis++)
    box.lo[axis] = -1.25, box.hi[axis] = -1.25 + side, box.periodic[axis] = periodic;
  return box;
}

static std::vector<glm::dvec3> nodes_of(const conceg_box &box, NodeSet set, double density = 2.0,
                                        bool mirrored = false) {
  Workers workers(1);
  NodeOptions options;
  options.set = set;
  options.density_per_um3 = density;
  options.mirrored_faces = mirrored;
  return make_nodes(box, options, workers, {});
}

static Network network_of(const conceg_box &box, const std::vector<glm::dvec3> &nodes, double tile,
                          double halo, unsigned threads, bool mirrored = false,
                          std::uint64_t *widened = nullptr) {
  Workers workers(threads);
  Edges edges = delaunay_edges(box, nodes, {tile, halo, mirrored}, workers, {});
  if (widened) *widened = edges.widened;
  Network network;
  network.offset.resize(nodes.size() + 1);
  network.neighbour.resize(edges.count);
  network.shift.resize(3 * edges.count);
  merge_tiles(std::move(edges), nodes.size(), network.offset.data(), network.neighbour.data(),
              network.shift.data());
  return network;
}

static bool symmetric(const std::set<Edge> &edges) {
  return std::all_of(edges.begin(), edges.end(), [&](const Edge &e) {
    return edges.count({e[1], e[0], -e[2], -e[3], -e[4]}) == 1;
  });
}

static std::set<Edge> by_periodic_3(const conceg_box &box, const std::vector<glm::dvec3> &nodes) {
  using Traits = CGAL::Periodic_3_Delaunay_triangulation_traits_3<Kernel>;
  using Periodic = CGAL::Periodic_3_Delaunay_triangulation_3<Traits>;
  std::map<std::array<double, 3>, std::uint32_t> id;
  std::vector<Kernel::Point_3> points;
  for (std::size_t i = 0; i < nodes.size(); i++) {
    id[{nodes[i].x, nodes[i].y, nodes[i].z}] = static_cast<std::uint32_t>(i);
    points.emplace_back(nodes[i].x, nodes[i].y, nodes[i].z);
  }
  const Periodic::Iso_cuboid cuboid(box.lo[0], box.lo[1], box.lo[2], box.hi[0], box.hi[1], box.hi[2]);
  Periodic periodic(cuboid);
  periodic.insert(points.begin(), points.end(), true);
  std::set<Edge> edges;
  for (auto cell = periodic.finite_cells_begin(); cell != periodic.finite_cells_end(); ++cell)
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++) {
        if (i == j) continue;
        const auto a = periodic.periodic_point(cell, i), b = periodic.periodic_point(cell, j);
        const auto node = [&](const auto &p) { return id.at({p.first.x(), p.first.y(), p.first.z()}); };
        edges.insert({node(a), node(b), b.second[0] - a.second[0], b.second[1] - a.second[1],
                      b.second[2] - a.second[2]});
      }
  return edges;
}

static void test_equals_periodic_3() {
  const conceg_box box = cube(12);
  for (const NodeSet set : {NodeSet::bcc, NodeSet::uniform}) {
    const auto nodes = nodes_of(box, set);
    const Network network = network_of(box, nodes, 6, 3, 1);
    const std::set<Edge> edges = network.edges();
    CHECK_EQUAL(edges.size(), network.neighbour.size());
    CHECK(symmetric(edges));
    CHECK(edges == by_periodic_3(box, nodes));
    const double degree = static_cast<double>(edges.size()) / static_cast<double>(nodes.size());
    CHECK_NEAR(degree, set == NodeSet::bcc ? 14.3 : 15.54, 0.2); // uniform: 2 + 48 pi^2 / 35 in theory
  }
}

static void test_tiles_and_threads() {
  conceg_box box = cube(12);
  box.hi[1] = box.lo[1] + 17.5;
  for (const NodeSet set : {NodeSet::bcc, NodeSet::uniform}) {
    const auto nodes = nodes_of(box, set);
    const Network whole = network_of(box, nodes, 100, 3, 1);
    for (const double tile : {4.0, 7.0})
      for (const unsigned threads : {1u, 2u, 3u})
        CHECK(whole == network_of(box, nodes, tile, 3, threads));
    std::uint64_t widened = 0; // a halo that is too thin is noticed and widened, and the edges stay right
    CHECK(whole == network_of(box, nodes, 6, 0.4, 2, false, &widened));
    CHECK(widened > 0);
  }
}

static void test_translation() {
  const conceg_box box = cube(9);
  const auto nodes = nodes_of(box, NodeSet::uniform);
  const glm::dvec3 vector(3.25, -17.0 - 0x1p-16, 4.5);
  std::vector<glm::dvec3> moved;
  std::vector<glm::ivec3> lifts;
  for (const glm::dvec3 &p : nodes) {
    moved.push_back(wrap(box, p + vector));
    lifts.push_back(lift(box, p + vector));
  }
  std::set<Edge> expected;
  for (Edge e : network_of(box, nodes, 5, 3, 1).edges()) {
    for (int axis = 0; axis < 3; axis++)
      e[2 + axis] += lifts[e[1]][axis] - lifts[e[0]][axis];
    expected.insert(e);
  }
  CHECK(expected == network_of(box, moved, 5, 3, 1).edges());
}

// A box far smaller than the halo: a node sees several images of one neighbour, and of itself.
static void test_small_box() {
  conceg_box box = cube(1.5);
  const auto nodes = nodes_of(box, NodeSet::uniform);
  CHECK_EQUAL(nodes.size(), 7);
  const std::set<Edge> edges = network_of(box, nodes, 50, 3, 1).edges();
  CHECK(symmetric(edges));
  CHECK(std::any_of(edges.begin(), edges.end(), [](const Edge &e) { return e[0] == e[1]; }));
  // The same nodes repeated 4 x 4 x 4 times make the same tissue, now in a box that is not small.
  const conceg_box large = cube(6);
  std::vector<glm::dvec3> repeated;
  for (int x = 0; x < 4; x++)
    for (int y = 0; y < 4; y++)
      for (int z = 0; z < 4; z++)
        for (const glm::dvec3 &p : nodes)
          repeated.push_back(p + glm::dvec3(x, y, z) * 1.5);
  const Network big = network_of(large, repeated, 50, 3, 1);
  CHECK_EQUAL(big.neighbour.size(), 64 * edges.size());
  CHECK(big.edges() == by_periodic_3(large, repeated));
}

// An open box: no edge leaves it, none is the long sliver of a convex hull, and inside nothing changes.
static void test_open_sides() {
  const conceg_box open = cube(10, false), closed = cube(10, true);
  const auto nodes = nodes_of(open, NodeSet::uniform);
  const Network network = network_of(open, nodes, 100, 3, 1);
  CHECK(network == network_of(open, nodes, 4, 3, 2));
  const std::set<Edge> edges = network.edges(), torus = network_of(closed, nodes, 100, 3, 1).edges();
  CHECK(symmetric(edges));
  double longest = 0.0;
  const auto deep = [&](std::int64_t i) {
    for (int axis = 0; axis < 3; axis++)
      if (nodes[i][axis] < open.lo[axis] + 3 || nodes[i][axis] > open.hi[axis] - 3) return false;
    return true;
  };
  std::size_t inside = 0;
  for (const Edge &e : edges) {
    CHECK(e[2] == 0 && e[3] == 0 && e[4] == 0);
    const glm::dvec3 d = nodes[e[0]] - nodes[e[1]];
    longest = std::max(longest, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
    if (!deep(e[0])) continue;
    inside++;
    CHECK(torus.count(e) == 1);
  }
  CHECK(inside > 1000);
  CHECK(longest < 4.0);
}

// The paper's faces: paths leave the box through nodes on its faces only, and arrive at the twin.
static void test_mirrored_faces() {
  const conceg_box box = cube(10);
  const auto nodes = nodes_of(box, NodeSet::uniform, 2.0, true);
  const Network network = network_of(box, nodes, 50, 3, 1, true);
  CHECK(network == network_of(box, nodes, 4, 3, 3, true));
  const std::set<Edge> edges = network.edges();
  CHECK_EQUAL(edges.size(), network.neighbour.size());
  CHECK(symmetric(edges));
  std::size_t crossing = 0;
  for (const Edge &e : edges)
    for (int axis = 0; axis < 3; axis++) {
      if (e[2 + axis] == 0) continue;
      crossing++;
      const std::int64_t on_face = e[2 + axis] > 0 ? e[1] : e[0]; // the image of a node on the lower face
      CHECK(nodes[on_face][axis] == box.lo[axis]);
      CHECK(e[2 + axis] == 1 || e[2 + axis] == -1);
    }
  CHECK(crossing > 1000);
}

static void test_circumsphere() {
  const double a[3] = {0, 0, 0}, b[3] = {2, 0, 0}, c[3] = {0, 2, 0}, d[3] = {0, 0, 2}, flat[3] = {2, 2, 0};
  Sphere sphere{};
  CHECK(circumsphere({a, b, c, d}, sphere));
  for (int axis = 0; axis < 3; axis++)
    CHECK_NEAR(sphere.center[axis], 1.0, 1e-15);
  CHECK_NEAR(sphere.radius, std::sqrt(3.0), 1e-15);
  CHECK(!circumsphere({a, b, c, flat}, sphere));
  // One lattice step off the plane of the others: a sphere of 2^17 um and more, not lost in rounding.
  const double sliver[3] = {1.5, 1.5, CONCEG_LATTICE_STEP_UM};
  CHECK(circumsphere({a, b, c, sliver}, sphere));
  CHECK(sphere.radius > 4e4);
  const double off[3] = {0, 0.3, 1};
  CHECK(!circumsphere({a, b, c, off}, sphere));
}

// A caller that says stop ends the run, from any worker.
static void test_cancel() {
  const conceg_box box = cube(12);
  const auto nodes = nodes_of(box, NodeSet::bcc);
  for (const unsigned threads : {1u, 2u}) {
    Workers workers(threads);
    conceg_status status = CONCEG_OK;
    try {
      delaunay_edges(box, nodes, {4, 3, false}, workers,
                     [](const char *, std::uint64_t, std::uint64_t) { return false; });
    } catch (const Error &error) {
      status = error.status();
    }
    CHECK_EQUAL(status, CONCEG_E_CANCELLED);
  }
}

int main() {
  test_cancel();
  test_circumsphere();
  test_equals_periodic_3();
  test_tiles_and_threads();
  test_translation();
  test_small_box();
  test_open_sides();
  test_mirrored_faces();
  return check_done();
}
