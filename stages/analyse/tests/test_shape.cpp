// SPDX-License-Identifier: BSD-3-Clause
// Branches, angles, cable, bars and the tables made of them.
#include "../tables.hpp"
#include "check.h"
#include "shapes.hpp"

#include <cmath>

using namespace conceg;
using namespace conceg::analyse;
using namespace shapes;

namespace {

constexpr double pi = 3.14159265358979323846;

const Column *find(const Table &table, const char *name) {
  for (const Column &column : table.columns)
    if (column.name == name) return &column;
  fprintf(stderr, "table %s has no column %s\n", table.name.c_str(), name);
  return nullptr;
}

double value(const Table &table, const char *name) {
  const Column *names = find(table, "name"), *values = find(table, "value");
  for (std::size_t row = 0; names && values && row < names->texts.size(); row++)
    if (names->texts[row] == name) return values->reals[row];
  return NAN;
}

void straightness_of_lines() {
  CHECK_NEAR(straightness({{0, 0, 0}, {3, 4, 0}, {6, 8, 0}}, 1), 1, 1e-12);
  std::vector<glm::dvec3> half, zigzag;
  for (int i = 0; i <= 4000; i++)
    half.push_back(50.0 * glm::dvec3(std::cos(pi * i / 4000), std::sin(pi * i / 4000), 0));
  CHECK_NEAR(straightness(half, 1), 2 / pi, 1e-4);
  for (int i = 0; i <= 100; i++)
    zigzag.push_back({5.0 * i, i % 2 ? 5.0 : 0.0, 0});
  CHECK_NEAR(straightness(zigzag, 1), std::sqrt(0.5), 0.02);
  CHECK_NEAR(straightness({{1, 2, 3}}, 1), 1, 0);
}

// A stem of 10 um and two daughters that leave it at 30 degrees to either side.
Skeletons fork(const glm::dvec3 &origin) {
  Skeletons s;
  std::vector<glm::dvec3> position;
  std::vector<std::int64_t> parent;
  for (int i = 0; i <= 10; i++)
    position.push_back(origin + glm::dvec3(0, 0, i)), parent.push_back(i - 1);
  for (int side = -1; side <= 1; side += 2)
    for (int i = 1; i <= 20; i++) {
      position.push_back(origin + glm::dvec3(0.5 * side * i, 0, 10 + std::sqrt(0.75) * i));
      parent.push_back(i == 1 ? 10 : static_cast<std::int64_t>(position.size()) - 2);
    }
  add_tree(s, position, parent, 0.5f, 4);
  return s;
}

void branches_of_a_fork() {
  Cells cells;
  add_cell(cells, {5, 5, -2}, 2);
  const Skeletons s = fork({5, 5, 0});
  check(s, cells);
  const Morphometry shape = measure_shape(cells, s);
  CHECK_EQUAL(shape.sections.size(), 3);
  CHECK_EQUAL(shape.forks.size(), 1);
  CHECK_NEAR(shape.forks[0].angle, pi / 3, 1e-12);
  CHECK_EQUAL(shape.sections[0].order, 1);
  CHECK_EQUAL(shape.sections[1].order, 2);
  CHECK_EQUAL(shape.sections[2].order, 2);
  CHECK_NEAR(shape.sections[0].length, 10, 1e-12);
  CHECK_NEAR(shape.sections[1].length, 20, 1e-12);
  CHECK_NEAR(shape.sections[2].straightness, 1, 1e-9);
  CHECK(shape.sections[1].tip && !shape.sections[0].tip);
  CHECK_EQUAL(shape.apical[0].tips, 2);
  CHECK_EQUAL(shape.apical[0].pia_side, 2);
  cells.pia = {0, 0, -1};
  CHECK_EQUAL(measure_shape(cells, s).apical[0].pia_side, 0);
  const std::vector<CellCable> cable = measure_cable(s);
  CHECK_NEAR(cable[0][3].length, 50, 1e-9);
  CHECK_NEAR(cable[0][3].mean_radius(), 0.5, 1e-9);
  CHECK_NEAR(cable[0][2].length, 0, 0);
}

void bars_and_tables() {
  Cells cells;
  add_cell(cells, {5, 5, -2}, 2);
  Bars bars;
  bars.cell_offset = {0, 3};
  bars.asked_start = {0, 4, 6}, bars.asked_end = {30, 14, 9};
  bars.achieved_start = {0, 4.5, 0}, bars.achieved_end = {30, 10.5, 0};
  bars.state = {1, 2, 3};
  check(bars, cells);
  Measures m;
  m.box_volume = 1000;
  m.bars = count_bars(bars);
  CHECK_NEAR(m.bars[0].asked, 43, 1e-12);
  CHECK_NEAR(m.bars[0].missing, 7, 1e-12);
  m.cable = measure_cable(fork({5, 5, 0}));
  m.shape = measure_shape(cells, fork({5, 5, 0}));
  const Table summary = summary_table(cells, m);
  CHECK_NEAR(value(summary, "cable_density"), 50 * 1e6 / 1000, 1e-6); // 50 um in 1000 um3
  CHECK_NEAR(value(summary, "bars_missing"), 7, 1e-12);
  CHECK_NEAR(value(summary, "apical_cells_pia_side"), 1, 0);
  CHECK(std::isnan(value(summary, "icvf_mesh"))); // no meshes, so left out
  const Table rows = bars_table(cells, m);
  CHECK_EQUAL(rows.rows(), 2);
  const Column *lost = find(rows, "lost");
  CHECK(lost && lost->wholes[0] == 1 && lost->wholes[1] == 1);
  for (const Table &table : {summary, rows, class_table(cells, m), type_table(cells, m), cell_table(cells, m),
                             neurite_table(cells, m), morphometry_table(cells, m)}) {
    CHECK(table.rows() > 0);
    for (const Column &column : table.columns)
      CHECK_EQUAL(column.rows(), table.rows());
    CHECK_EQUAL(table.lines().size(), table.rows() + 1);
  }
  bars.state[1] = 5;
  bool refused = false;
  try {
    check(bars, cells);
  } catch (const Error &) {
    refused = true;
  }
  CHECK(refused);
}

void spread() {
  const Spread s = spread_of({1, 2, 3, 4});
  CHECK_EQUAL(s.count, 4);
  CHECK_NEAR(s.mean, 2.5, 1e-12);
  CHECK_NEAR(s.sd, std::sqrt(1.25), 1e-12);
  CHECK_EQUAL(spread_of({}).count, 0);
}

} // namespace

int main() {
  straightness_of_lines();
  branches_of_a_fork();
  bars_and_tables();
  spread();
  return check_done();
}
