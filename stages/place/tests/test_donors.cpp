// SPDX-License-Identifier: BSD-3-Clause
// Donors: turning about the pia, uniform spin, bars with parents first, radius law, axons, donors held back,
// subsets, broken dictionaries.
#include "../donors.hpp"

#include "check.h"
#include "guard.hpp"

#include <cmath>
#include <functional>
#include <string>

using namespace conceg;
using namespace conceg::place;

// Two entries. "pyramidal": one donor, a basal tree of 3 bars whose rows stand child before parent, an apical
// tree that points up, and an axon. "glia": two donors of unknown frame with one bar each.
static Dictionary example() {
  Dictionary d;
  d.entry.name = {"pyramidal", "glia"};
  d.entry.class_name = {"pyramidal", "astrocyte"};
  d.entry.donor_offset = {0, 1, 3};
  d.entry.angle_offset = {0, 2, 3};
  d.angle = {0.5, 0.75, 1.25};
  d.donor.id = {"p", "g1", "g2"};
  d.donor.frame_kind = {"apical", "unknown", "unknown"};
  d.donor.frame = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  d.donor.fold = {1, 2, 0};
  d.donor.soma_radius = {7, 4, 4.5};
  d.donor.tree_offset = {0, 3, 4, 5};
  d.tree.neurite = {3, 4, 2, 7, 7};
  d.tree.trunk_direction = {{1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}};
  d.tree.bar_offset = {0, 3, 4, 5, 6, 7};
  d.bar.parent = {1, 2, -1, -1, -1, -1, -1};
  d.bar.birth = {30, 20, 0, 0, 0, 0, 0};
  d.bar.death = {50, 60, 100, 300, 500, 20, 30};
  d.bar.radius = {0.25, 0.3, 0.5, 0.6, 0.2, 0.2, 0.3};
  d.bar.taper = {0, -0.001, -0.002, -0.001, 0, 0, 0};
  d.bar.angle = {0.9, 1.1, 0, 0, 0, 0, 0};
  d.bar.tip_direction = {{1, 0, 0}, {0.6, 0.8, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}};
  d.bar.tip_distance = {55, 65, 100, 305, 400, 24, 33};
  return d;
}

static CellDraw cell_of(const Dictionary &d, std::size_t donor, std::uint64_t id,
                        const DonorOptions &options) {
  return {id, donor, draw_rotation(d, donor, id, options), {10, 20, 30}, 2.0};
}

static void test_bars() {
  const Dictionary d = example();
  const Pool pool = pool_of(d, 0);
  DonorOptions options;
  Bars bars;
  append_cell(d, pool, cell_of(d, 0, 5, options), options, bars);
  CHECK_EQUAL(bars.tree.size(), 4); // no axon
  CHECK(bars.parent == (std::vector<std::int64_t>{-1, 0, 1, -1}));
  CHECK(bars.tree == (std::vector<std::uint32_t>{0, 0, 0, 1}));
  CHECK(bars.neurite == (std::vector<std::uint8_t>{3, 3, 3, 4}));
  CHECK(bars.start == (std::vector<double>{0, 20, 30, 0}));
  CHECK(bars.end == (std::vector<double>{100, 60, 50, 300}));
  CHECK(bars.radius == (std::vector<double>{1.0, 0.6, 0.5, 1.2}));
  CHECK(bars.taper == (std::vector<double>{-0.004, -0.002, 0, -0.002}));
  CHECK(bars.angle == (std::vector<double>{0, 1.1, 0.9, 0}));
  CHECK_NEAR(bars.radius_floor[2], 0.15, 0);
  // The apical tip stands straight above the soma for every azimuth; basal tips keep their distance and
  // height.
  CHECK_NEAR(bars.attractor[3].x, 10, 1e-9);
  CHECK_NEAR(bars.attractor[3].z, 335, 1e-9);
  CHECK_NEAR(bars.attractor[0].z, 30, 1e-9);
  CHECK_NEAR(std::hypot(bars.attractor[0].x - 10, bars.attractor[0].y - 20), 100, 1e-9);

  options.axons = true;
  append_cell(d, pool, cell_of(d, 0, 6, options), options, bars);
  CHECK_EQUAL(bars.tree.size(), 9);
  CHECK(bars.cell_offset == (std::vector<std::uint64_t>{0, 4, 9}));
  CHECK_EQUAL(bars.tree[8], 2);
  CHECK_EQUAL(bars.parent[4 + 2], 1); // rows count within the cell

  options.drawn_angles = true;
  append_cell(d, pool, cell_of(d, 0, 6, options), options, bars);
  CHECK_NEAR(bars.angle[9], 0, 0);
  CHECK(bars.angle[10] == 0.5 || bars.angle[10] == 0.75);
}

static void test_pia() {
  const Dictionary d = example();
  for (const glm::dvec3 pia :
       {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0, -0.6, 0.8), glm::dvec3(0, 0, -1)}) {
    DonorOptions options;
    options.pia = pia;
    const glm::dquat q = draw_rotation(d, 0, 77, options);
    CHECK_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1.0, 1e-12);
    const glm::dvec3 up = q * glm::dvec3(0, 0, 1), level = q * glm::dvec3(1, 0, 0);
    for (int axis = 0; axis < 3; axis++)
      CHECK_NEAR(up[axis], pia[axis], 1e-12);
    CHECK_NEAR(level.x * pia.x + level.y * pia.y + level.z * pia.z, 0.0, 1e-12);
  }
}

// Azimuths are even about the pia; cells of unknown frame point everywhere.
static void test_directions() {
  const Dictionary d = example();
  const DonorOptions options;
  const int count = 20000;
  glm::dvec3 level(0), spun(0), square(0);
  for (int i = 0; i < count; i++) {
    level += draw_rotation(d, 0, static_cast<std::uint64_t>(i), options) * glm::dvec3(1, 0, 0);
    const glm::dvec3 v =
        draw_rotation(d, 1, static_cast<std::uint64_t>(i), options) * glm::dvec3(0, 0.6, 0.8);
    spun += v, square += v * v;
  }
  for (int axis = 0; axis < 3; axis++) {
    CHECK_NEAR(level[axis] / count, 0.0, 0.02);
    CHECK_NEAR(spun[axis] / count, 0.0, 0.02);
    CHECK_NEAR(square[axis] / count, 1.0 / 3.0, 0.01);
  }
  const Pool glia = pool_of(d, 1);
  int first = 0;
  for (int i = 0; i < count; i++)
    first += draw_donor(glia, static_cast<std::uint64_t>(i), 1) == 1;
  CHECK_NEAR(first / static_cast<double>(count), 0.5, 0.015);
  CHECK_EQUAL(draw_donor(pool_of(d, 0), 3, 1), 0);
}

static bool contains(const std::string &text, const char *part) {
  return text.find(part) != std::string::npos;
}

// Marks and what is left to draw; the angles of a pool with held-back donors are those of its own bars.
static void test_hold_back() {
  Dictionary d = example();
  CHECK(pool_of(d, 0).angles == (std::vector<double>{0.5, 0.75}));
  CHECK(hold_back(d, 2) == (std::vector<std::string>{"pyramidal"})); // has no donor of the fold
  CHECK(d.donor.validation == (std::vector<std::uint8_t>{0, 1, 0}));
  CHECK(pool_of(d, 1).donors == (std::vector<std::size_t>{2}));
  CHECK_EQUAL(pool_of(d, 1).trees[7].size(), 1);
  CHECK_EQUAL(pool_of(d, 1).trees[7][0].tree, 4);
  CHECK(pool_of(d, 0).angles == (std::vector<double>{0.9, 1.1}));
  CHECK(subset(d, {1}).donor.validation == (std::vector<std::uint8_t>{1, 0}));
  CHECK(hold_back(d, -1).empty());
  CHECK(d.donor.validation.empty());
  CHECK(pool_of(d, 1).donors == (std::vector<std::size_t>{1, 2}));
  std::string line;
  try {
    hold_back(d, 1);
  } catch (const Error &error) {
    line = error.what();
  }
  CHECK(contains(line, "fold 1 in dictionary entry pyramidal, got none; choose another fold"));
}

static void test_subset() {
  const Dictionary d = example(), glia = subset(d, {1});
  CHECK_EQUAL(glia.entry.name.size(), 1);
  CHECK_TEXT(glia.donor.id[1].c_str(), "g2");
  CHECK(glia.donor.tree_offset == (std::vector<std::uint64_t>{0, 1, 2}));
  CHECK(glia.tree.bar_offset == (std::vector<std::uint64_t>{0, 1, 2}));
  CHECK(glia.angle == (std::vector<double>{1.25}));
  CHECK(glia.bar.death == (std::vector<double>{20, 30}));
  CHECK_EQUAL(glia.donor.frame.size(), 8);
  CHECK(glia.donor.fold == (std::vector<std::uint8_t>{2, 0}));
  CHECK(glia.bar.cv.empty()); // left out stays left out
  CHECK_EQUAL(glia.find("glia"), 0);
  CHECK_EQUAL(glia.find("pyramidal"), -1);
  const Dictionary both = subset(d, {1, 0});
  CHECK(both.entry.donor_offset == (std::vector<std::uint64_t>{0, 2, 3}));
  CHECK(both.bar.death == (std::vector<double>{20, 30, 50, 60, 100, 300, 500}));
}

static std::string broken(const std::function<void(Dictionary &)> &damage) {
  Dictionary d = example();
  damage(d);
  try {
    parents_first(d, 0);
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

int main() {
  test_bars();
  test_pia();
  test_directions();
  test_hold_back();
  test_subset();
  CHECK(contains(broken([](Dictionary &d) { d.bar.parent[2] = 0; }), "got a cycle"));
  CHECK(contains(broken([](Dictionary &d) { d.bar.parent[0] = 3; }), "bar_parent[0]"));
  CHECK(contains(broken([](Dictionary &d) { d.bar.parent[0] = -2; }), "got -2"));
  CHECK(contains(broken([](Dictionary &d) { d.bar.death[1] = 20; }), "bar_death[1]"));
  CHECK(broken([](Dictionary &) {}).empty());
  return check_done();
}
