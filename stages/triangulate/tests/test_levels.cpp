// SPDX-License-Identifier: GPL-3.0-or-later
// Graded nodes: which cells are cut, steps of one level between cells that meet, finer spacing where it was
// asked for and the very nodes of bcc elsewhere, the same for any number of threads.
#include "../nodes.hpp"
#include "../tissue.hpp"

#include "check.h"
#include "conceg/rng.h"
#include "wrap.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

using namespace conceg;
using namespace conceg::triangulate;

using Place = std::tuple<double, double, double>;

static conceg_box box_of(double x, double y, double z, bool periodic) {
  conceg_box box = {};
  const double side[3] = {x, y, z};
  for (int axis = 0; axis < 3; axis++)
    box.lo[axis] = -3.5, box.hi[axis] = -3.5 + side[axis], box.periodic[axis] = periodic;
  return box;
}

static glm::dvec3 cell_center(const Lattice &lattice, std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return {lattice.box.lo[0] + lattice.width(0) * (static_cast<double>(x) + 0.5),
          lattice.box.lo[1] + lattice.width(1) * (static_cast<double>(y) + 0.5),
          lattice.box.lo[2] + lattice.width(2) * (static_cast<double>(z) + 0.5)};
}

static double distance(const conceg_box &box, const glm::dvec3 &a, const glm::dvec3 &b) {
  const glm::dvec3 d = nearest(box, a - b);
  return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

// visit(cell, center, level of the cell)
template <class Visit>
static void each_cell(const Lattice &lattice, const std::vector<std::uint8_t> &levels, Visit &&visit) {
  std::uint64_t cell = 0;
  for (std::uint64_t z = 0; z < lattice.cells[2]; z++)
    for (std::uint64_t y = 0; y < lattice.cells[1]; y++)
      for (std::uint64_t x = 0; x < lattice.cells[0]; x++, cell++)
        visit(cell, cell_center(lattice, x, y, z), levels[cell]);
}

// Largest difference of level between two cells that meet.
static int largest_step(const Lattice &lattice, const std::vector<std::uint8_t> &levels) {
  int largest = 0;
  const auto n = lattice.cells;
  for (std::uint64_t i = 0; i < levels.size(); i++) {
    const std::array<std::uint64_t, 3> at = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
    for (unsigned step = 0; step < 27; step++) {
      std::array<std::uint64_t, 3> to;
      const std::array<unsigned, 3> by = {step % 3, step / 3 % 3, step / 9};
      bool inside = true;
      for (int axis = 0; axis < 3; axis++) {
        to[axis] = (at[axis] + by[axis] + n[axis] - 1) % n[axis];
        inside = inside && (lattice.box.periodic[axis] || to[axis] + 1 == at[axis] + by[axis]);
      }
      if (inside)
        largest = std::max(largest, std::abs(levels[i] - levels[to[0] + n[0] * (to[1] + n[1] * to[2])]));
    }
  }
  return largest;
}

static void test_levels_around_somas() {
  for (const bool periodic : {true, false}) {
    const conceg_box box = box_of(30, 26, 22, periodic);
    const Lattice lattice = lattice_of(box, 2.0);
    const std::vector<Soma> somas = {{{-3, 0, 0}, 7}, {{15, 10, 8}, 5}, {{20, 20, 3}, 0}};
    const auto levels = grade_levels(lattice, soma_zones(somas, 2, 1.5), somas);
    CHECK_EQUAL(levels.size(), 30 * 26 * 22);
    std::array<std::size_t, 3> seen{};
    std::size_t hollow = 0;
    each_cell(lattice, levels, [&](std::uint64_t, const glm::dvec3 &center, unsigned level) {
      double off = HUGE_VAL; // distance to the nearest surface
      for (const Soma &soma : somas)
        if (soma.radius > 0) off = std::min(off, distance(box, center, soma.center) - soma.radius);
      seen[level]++;
      if (off > -0.8 && off <= 1.5) CHECK_EQUAL(level, 2);
      if (off > 1.5 && off <= 3.0) CHECK(level >= 1);
      if (off > 3.0 + 2 * std::sqrt(3.0)) CHECK_EQUAL(level, 0); // steps of one level reach two cells at most
      if (off < -1.0 - 2 * std::sqrt(3.0)) {
        hollow++;
        CHECK_EQUAL(level, 0);
      }
    });
    CHECK(seen[0] > 1000 && seen[1] > 1000 && seen[2] > 1000 && hollow > 0);
    CHECK_EQUAL(largest_step(lattice, levels), 1);
  }
}

// Zones anywhere and of any size, also wider than the box: each cell against every zone's nearest image.
static void test_levels_of_zones() {
  conceg_rng rng = conceg_rng_stream(1, "test", 1);
  for (const bool periodic : {true, false})
    for (int round = 0; round < 20; round++) {
      const conceg_box box = box_of(9, 12.5, 3, periodic);
      const Lattice lattice = lattice_of(box, 2.0);
      std::vector<Zone> zones;
      for (int i = 0; i < 3; i++) {
        glm::dvec3 center;
        for (int axis = 0; axis < 3; axis++)
          center[axis] = -8.0 + 25.0 * conceg_rng_uniform(&rng);
        zones.push_back({center, 8.0 * conceg_rng_uniform(&rng), 1});
      }
      const auto levels = grade_levels(lattice, zones, {});
      each_cell(lattice, levels, [&](std::uint64_t, const glm::dvec3 &center, unsigned level) {
        bool within = false;
        for (const Zone &zone : zones)
          within = within || distance(box, center, zone.center) <= zone.radius_um;
        CHECK_EQUAL(level, within ? 1 : 0);
      });
      for (Zone &zone : zones)
        zone.level = 2, zone.radius_um *= 0.3;
      CHECK(largest_step(lattice, grade_levels(lattice, zones, {})) <= 1);
    }
}

// A node spacing of 0.8 um, at most 2 mean radii, at most two halvings, at most 30 um away.
static void test_thin_zones() {
  const auto zones = thin_zones({{{1, 2, 3}, 20, 0.5},  // 0.8 <= 1
                                 {{2, 2, 3}, 21, 0.3},  // 0.4 <= 0.6
                                 {{3, 2, 3}, 22, 0.15}, // 0.2 <= 0.3
                                 {{4, 2, 3}, 23, 0.01}, // would need five halvings
                                 {{5, 2, 3}, 31, 0.1}}, // too far
                                0.8, 2.0, 30.0, 2);
  CHECK_EQUAL(zones.size(), 3);
  const unsigned level[3] = {1, 2, 2};
  for (int i = 0; i < 3; i++) {
    CHECK_EQUAL(zones[i].level, level[i]);
    CHECK_EQUAL(zones[i].center.x, 2 + i);
    CHECK_EQUAL(zones[i].radius_um, 21 + i);
  }
  CHECK(thin_zones({{{1, 2, 3}, 20, 0.1}}, 0.8, 2.0, 30.0, 0).empty());
}

struct Graded {
  conceg_box box = box_of(24, 24, 24, true);
  std::vector<Soma> somas = {{{-2, 1, 1}, 4}};
  Lattice lattice = lattice_of(box, 2.0);
  NodeOptions options;
  explicit Graded(unsigned finest) {
    options.levels = grade_levels(lattice, soma_zones(somas, finest, 2.0), somas);
  }
  std::vector<glm::dvec3> nodes(unsigned threads = 1) const {
    Workers workers(threads);
    return make_nodes(box, options, workers, {});
  }
};

static std::set<Place> places_of(const std::vector<glm::dvec3> &nodes) {
  std::set<Place> places;
  for (const glm::dvec3 &p : nodes)
    places.insert({p.x, p.y, p.z});
  return places;
}

static void test_nodes() {
  Graded graded(2);
  const auto nodes = graded.nodes();
  const auto by_level = nodes_by_level(graded.options.levels);
  CHECK_EQUAL(nodes.size(), by_level[0] + by_level[1] + by_level[2]);
  CHECK_EQUAL(places_of(nodes).size(), nodes.size()); // none twice
  for (const glm::dvec3 &p : nodes)
    for (int axis = 0; axis < 3; axis++)
      CHECK(p[axis] == conceg_snap(p[axis]) && p[axis] >= graded.box.lo[axis] &&
            p[axis] < graded.box.hi[axis]);
  CHECK(nodes == graded.nodes(2));
  CHECK(nodes == graded.nodes(3));

  // Every cell holds its own nodes, and an uncut one those of bcc.
  std::vector<std::uint64_t> held(graded.lattice.count());
  const auto &cells = graded.lattice.cells;
  NodeOptions plain;
  Workers workers(1);
  const std::set<Place> bcc = places_of(make_nodes(graded.box, plain, workers, {}));
  std::size_t kept = 0;
  for (const glm::dvec3 &p : nodes) {
    std::array<std::uint64_t, 3> at;
    for (int axis = 0; axis < 3; axis++)
      at[axis] = static_cast<std::uint64_t>((p[axis] - graded.box.lo[axis]) / graded.lattice.width(axis));
    const std::uint64_t cell = at[0] + cells[0] * (at[1] + cells[1] * at[2]);
    held[cell]++;
    kept += bcc.count({p.x, p.y, p.z});
  }
  CHECK_EQUAL(kept, by_level[0]);
  for (std::size_t cell = 0; cell < held.size(); cell++)
    CHECK_EQUAL(held[cell], nodes_in_cell(graded.options.levels[cell]));

  graded.options.levels.assign(graded.lattice.count(), 0);
  CHECK(graded.nodes() == make_nodes(graded.box, plain, workers, {}));
}

// Mean distance to the nearest other node, of nodes whose distance to the soma's surface is in [from, to).
static double spacing_at(const Graded &graded, const std::vector<glm::dvec3> &nodes, double from, double to) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const glm::dvec3 &a : nodes) {
    const double off = distance(graded.box, a, graded.somas[0].center) - graded.somas[0].radius;
    if (!(off >= from && off < to) || count == 300) continue;
    double best = HUGE_VAL;
    for (const glm::dvec3 &b : nodes)
      if (!(a == b)) best = std::min(best, distance(graded.box, a, b));
    sum += best, count++;
  }
  CHECK_EQUAL(count, 300);
  return sum / static_cast<double>(count);
}

static void test_spacing() {
  const Graded fine(2);
  const auto nodes = fine.nodes();
  const double far = spacing_at(fine, nodes, 6.5, 20);
  CHECK_NEAR(far, 0.65, 0.03); // as in bcc
  CHECK_NEAR(spacing_at(fine, nodes, 3.0, 3.5) / far, 0.5, 0.02);
  CHECK_NEAR(spacing_at(fine, nodes, 0.0, 1.0) / far, 0.25, 0.01);
}

int main() {
  test_levels_around_somas();
  test_levels_of_zones();
  test_thin_zones();
  test_nodes();
  test_spacing();
  return check_done();
}
