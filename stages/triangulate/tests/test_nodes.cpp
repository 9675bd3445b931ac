// SPDX-License-Identifier: GPL-3.0-or-later
// Node sets: counts, lattice, blue noise against Poisson noise, faces with their twins, any number of
// threads.
#include "../nodes.hpp"

#include "check.h"
#include "conceg/portable.h"
#include "wrap.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <tuple>

using namespace conceg;
using namespace conceg::triangulate;

static conceg_box box_of(double x, double y, double z, bool periodic) {
  conceg_box box = {};
  const double side[3] = {x, y, z};
  for (int axis = 0; axis < 3; axis++)
    box.lo[axis] = -3.5, box.hi[axis] = -3.5 + side[axis], box.periodic[axis] = periodic;
  return box;
}

static std::vector<glm::dvec3> nodes_of(const conceg_box &box, const NodeOptions &options,
                                        unsigned threads = 1) {
  Workers workers(threads);
  return make_nodes(box, options, workers, {});
}

static bool sound(const conceg_box &box, const std::vector<glm::dvec3> &nodes) {
  std::set<std::tuple<double, double, double>> places;
  for (const glm::dvec3 &p : nodes) {
    if (!places.insert({p.x, p.y, p.z}).second) return false;
    for (int axis = 0; axis < 3; axis++) {
      const bool below = box.periodic[axis] ? p[axis] < box.hi[axis] : p[axis] <= box.hi[axis];
      if (p[axis] != conceg_snap(p[axis]) || p[axis] < box.lo[axis] || !below) return false;
    }
  }
  return true;
}

// Mean distance to the nearest other node, over the periodic box.
static double nearest_mean(const conceg_box &box, const std::vector<glm::dvec3> &nodes) {
  double sum = 0.0;
  for (const glm::dvec3 &a : nodes) {
    double best = HUGE_VAL;
    for (const glm::dvec3 &b : nodes) {
      const glm::dvec3 d = nearest(box, a - b);
      const double d2 = d.x * d.x + d.y * d.y + d.z * d.z;
      if (d2 > 0.0) best = std::min(best, d2);
    }
    sum += std::sqrt(best);
  }
  return sum / static_cast<double>(nodes.size());
}

static void test_counts_and_noise() {
  const conceg_box box = box_of(12, 12, 12, true);
  NodeOptions options;
  const auto bcc = nodes_of(box, options);
  CHECK_EQUAL(bcc.size(), 2 * 12 * 12 * 12);
  CHECK(sound(box, bcc));
  options.set = NodeSet::uniform;
  const auto uniform = nodes_of(box, options);
  CHECK_EQUAL(uniform.size(), 3456);
  CHECK(sound(box, uniform));
  // A Poisson process of density 2 has a mean nearest distance of 0.554 rho^(-1/3); an unshifted lattice has
  // 0.866.
  CHECK_NEAR(nearest_mean(box, uniform), 0.55396 / std::cbrt(2.0), 0.01);
  CHECK(nearest_mean(box, bcc) > 0.63);
  options.set = NodeSet::bcc;
  options.jitter = 0.0;
  CHECK_NEAR(nearest_mean(box, nodes_of(box, options)), std::sqrt(0.75), 1e-4);
}

static void test_threads_and_seed() {
  const conceg_box box = box_of(20, 30, 11.5, true);
  for (const NodeSet set : {NodeSet::bcc, NodeSet::uniform}) {
    NodeOptions options;
    options.set = set;
    const auto one = nodes_of(box, options, 1);
    CHECK(one == nodes_of(box, options, 2));
    CHECK(one == nodes_of(box, options, 3));
    options.seed = 2;
    CHECK(one != nodes_of(box, options, 1));
  }
}

static void test_mirrored_faces() {
  NodeOptions options;
  options.set = NodeSet::uniform;
  options.mirrored_faces = true;
  conceg_box box = box_of(10, 10, 10, true);
  const auto closed = nodes_of(box, options);
  CHECK(sound(box, closed));
  const auto on_faces = [&](const std::vector<glm::dvec3> &nodes) {
    return std::count_if(nodes.begin(), nodes.end(), [&](const glm::dvec3 &p) {
      return p.x == box.lo[0] || p.y == box.lo[1] || p.z == box.lo[2] || p.x == box.hi[0] ||
             p.y == box.hi[1] || p.z == box.hi[2];
    });
  };
  // Three pairs of faces of 10 x 10 um at 2^(2/3) um^-2, three groups of edges at 2^(1/3) um^-1, one corner.
  const long face = std::lround(100 * std::pow(2.0, 2.0 / 3)), edge = std::lround(10 * std::cbrt(2.0));
  CHECK_EQUAL(on_faces(closed), 3 * face + 3 * edge + 1);
  CHECK_EQUAL(closed.size(), 2000 + 3 * face + 3 * edge + 1);
  for (int axis = 0; axis < 3; axis++)
    box.periodic[axis] = 0;
  CHECK_EQUAL(on_faces(nodes_of(box, options)), 6 * face + 12 * edge + 8);
}

static void test_errors() {
  NodeOptions options;
  const auto message = [&](const conceg_box &box) {
    try {
      nodes_of(box, options);
    } catch (const Error &error) {
      return std::string(error.what());
    }
    return std::string();
  };
  options.set = NodeSet::uniform;
  options.density_per_um3 = 1e-3;
  CHECK(message(box_of(2, 2, 2, true)).find("at least one node") != std::string::npos);
  options.density_per_um3 = 1e6;
  CHECK(message(box_of(2000, 2000, 2000, true)).find("2^32") != std::string::npos);
  options.density_per_um3 = 2;
  CHECK(message(box_of(0x1p-10, 2, 2, true)).find("/domain") != std::string::npos);
}

int main() {
  test_counts_and_noise();
  test_threads_and_seed();
  test_mirrored_faces();
  test_errors();
  return check_done();
}
