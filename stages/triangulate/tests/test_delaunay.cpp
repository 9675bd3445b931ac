// SPDX-License-Identifier: GPL-3.0-or-later
// The network's edges: the same for any tiles, threads and translation; small and open boxes; the paper's
// faces.
#include "../circumsphere.hpp"
#include "network.hpp"

#include "check.h"

using namespace conceg;
using namespace conceg::triangulate;

static bool has_edge(const std::vector<Edge> &edges, const Edge &edge) {
  return std::binary_search(edges.begin(), edges.end(), edge);
}

static void test_tiles_and_threads() {
  conceg_box box = cube(12);
  box.hi[1] = box.lo[1] + 17.5;
  for (const auto &nodes :
       {nodes_of(box, NodeSet::bcc), nodes_of(box, NodeSet::uniform), graded_nodes(box)}) {
    const Network whole = network_of(box, nodes, 100, 3, 1);
    for (const double tile : {4.0, 7.0})
      for (const unsigned threads : {1u, 2u, 3u})
        CHECK(whole == network_of(box, nodes, tile, 3, threads));
    std::uint64_t widened = 0; // a halo that is too thin is noticed and widened, and the edges stay right
    CHECK(whole == network_of(box, nodes, 6, 0.4, 2, false, &widened));
    CHECK(widened > 0);
    DelaunayOptions
        crowded; // two tiles by their size, halved until none holds more than 500 nodes or is one bucket
    crowded.tile_um = 100, crowded.tile_nodes = 500;
    Workers workers(2);
    CHECK(delaunay_edges(box, nodes, crowded, workers, {}).tiles.size() > 10);
    CHECK(whole == network_of(box, nodes, crowded, 2));
  }
}

// Whatever the draws and the levels, no empty sphere is larger than the lattice allows, so that the first
// halo is always wide enough.
static void test_halo_of_lattice() {
  conceg_box box = cube(11);
  box.hi[2] = box.lo[2] + 13.25; // cells are no cubes
  for (const double jitter : {0.0, 0.2, 0.24})
    for (const bool graded : {false, true}) {
      NodeOptions options = graded ? graded_options(box) : NodeOptions{};
      options.jitter = jitter;
      Workers workers(2);
      const auto nodes = make_nodes(box, options, workers, {});
      DelaunayOptions delaunay;
      delaunay.tile_um = 5, delaunay.halo_um = first_halo_um(box, options);
      std::uint64_t widened = 0;
      double largest = 0.0;
      network_of(box, nodes, delaunay, 2, &widened, &largest);
      CHECK_EQUAL(widened, 0);
      CHECK(largest <= empty_radius_um(lattice_of(box, options.density_per_um3), jitter, graded));
      CHECK(largest > 0.5 * empty_radius_um(lattice_of(box, options.density_per_um3), jitter, graded));
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
  std::vector<Edge> expected;
  for (Edge e : network_of(box, nodes, 5, 3, 1).edges()) {
    for (int axis = 0; axis < 3; axis++)
      e[2 + axis] += lifts[e[1]][axis] - lifts[e[0]][axis];
    expected.push_back(e);
  }
  std::sort(expected.begin(), expected.end());
  CHECK(expected == network_of(box, moved, 5, 3, 1).edges());
}

// A box far smaller than the halo: a node sees several images of one neighbour, and of itself.
static void test_small_box() {
  conceg_box box = cube(1.5);
  const auto nodes = nodes_of(box, NodeSet::uniform);
  CHECK_EQUAL(nodes.size(), 7);
  const std::vector<Edge> edges = network_of(box, nodes, 50, 3, 1).edges();
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
  const std::vector<Edge> edges = network.edges(), torus = network_of(closed, nodes, 100, 3, 1).edges();
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
    CHECK(has_edge(torus, e));
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
  const std::vector<Edge> edges = network.edges();
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

// So small a box that the halo would take more images of a node than a shift can count.
static void test_tiny_box() {
  const conceg_box box = cube(0.0625);
  const auto nodes = nodes_of(box, NodeSet::bcc, 1e-4);
  CHECK_EQUAL(nodes.size(), 2);
  std::string line;
  try {
    network_of(box, nodes, 50, 50, 1);
  } catch (const Error &error) {
    line = error.what();
  }
  CHECK(line.find("/domain: expected a side of more than 1/100 of the halo") != std::string::npos);
  CHECK(line.find("density_per_um3") != std::string::npos);
}

// A caller that says stop ends the run, from any worker.
static void test_cancel() {
  const conceg_box box = cube(12);
  const auto nodes = nodes_of(box, NodeSet::bcc);
  for (const unsigned threads : {1u, 2u}) {
    Workers workers(threads);
    conceg_status status = CONCEG_OK;
    try {
      delaunay_edges(box, nodes, {4, 3}, workers,
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
  test_tiles_and_threads();
  test_halo_of_lattice();
  test_translation();
  test_small_box();
  test_tiny_box();
  test_open_sides();
  test_mirrored_faces();
  return check_done();
}
