// SPDX-License-Identifier: BSD-3-Clause
#include "input.hpp"

#include "view.hpp"
#include "wrap.hpp"

#include <glm/geometric.hpp>

#include <cmath>

namespace conceg::grow {

namespace {

constexpr double least_choices = 3.0; // edges that a tip can take on average, or it cannot follow a direction
constexpr double least_side_um = 8.0; // nearest images must be unique for what one step looks at

void same_rows(const char *path, std::size_t got, const char *other, std::size_t expected) {
  if (got != expected)
    fail(CONCEG_E_FORMAT, "%s: expected %zu rows as in %s, got %zu", path, expected, other, got);
}

// A row of offsets: starts at 0, ascends, ends at `end`.
View<std::uint64_t> offsets(conceg_doc *doc, const char *path, std::size_t rows, std::size_t end) {
  const View<std::uint64_t> offset = view<std::uint64_t>(doc, path);
  if (offset.rows() != rows + 1)
    fail(CONCEG_E_FORMAT, "%s: expected %zu values, got %zu", path, rows + 1, offset.rows());
  if (offset[0] != 0)
    fail(CONCEG_E_RANGE, "%s[0]: expected 0, got %llu", path, static_cast<unsigned long long>(offset[0]));
  for (std::size_t i = 0; i < rows; i++)
    if (offset[i + 1] < offset[i]) fail(CONCEG_E_RANGE, "%s[%zu]: expected ascending offsets", path, i + 1);
  if (offset[rows] != end)
    fail(CONCEG_E_RANGE, "%s[%zu]: expected %zu, got %llu", path, rows, end,
         static_cast<unsigned long long>(offset[rows]));
  return offset;
}

void all_finite(const char *path, const double *values, std::size_t count) {
  for (std::size_t i = 0; i < count; i++)
    if (!std::isfinite(values[i]))
      fail(CONCEG_E_RANGE, "%s[%zu]: expected a finite number, got %g", path, i, values[i]);
}

// One column of /bars: as many rows as there are bars, finite.
const double *column(conceg_doc *doc, const char *path, std::size_t rows, std::size_t width = 1) {
  const View<double> values = view<double>(doc, path, width);
  same_rows(path, values.rows(), "/bars/tree", rows);
  all_finite(path, values.data(), rows * width);
  return values.data();
}

void read_box(conceg_doc *doc, Input &input) {
  input.box = conceg::read_box(doc);
  for (int a = 0; a < 3; a++) {
    const double side = conceg_box_side(&input.box, a);
    if (!(side >= least_side_um) || !(side < 1e5))
      fail(CONCEG_E_RANGE, "/domain: expected a side of %g um to 100 mm on axis %d, got %g um", least_side_um,
           a, side);
  }
}

void read_network(conceg_doc *doc, Input &input) {
  Network &network = input.network;
  const View<double> position = view<double>(doc, "/network/position", 3);
  network.nodes = position.rows(), network.position = position.data();
  if (network.nodes == 0)
    fail(CONCEG_E_RANGE, "/network/position: expected at least one node; run conceg triangulate again");
  if (network.nodes >= none)
    fail(CONCEG_E_RANGE, "/network/position: expected fewer than 2^32 - 1 nodes, got %zu", network.nodes);
  all_finite("/network/position", network.position, 3 * network.nodes);
  for (std::size_t i = 0; i < 3 * network.nodes; i++) {
    const int a = static_cast<int>(i % 3);
    if (network.position[i] < input.box.lo[a] || network.position[i] > input.box.hi[a])
      fail(CONCEG_E_RANGE, "/network/position[%zu]: expected a node in the box, got %g on axis %d", i / 3,
           network.position[i], a);
  }
  const View<float> radius = view<float>(doc, "/network/radius");
  same_rows("/network/radius", radius.rows(), "/network/position", network.nodes);
  network.radius = radius.data();
  for (std::size_t i = 0; i < network.nodes; i++)
    if (!std::isfinite(radius[i])) fail(CONCEG_E_RANGE, "/network/radius[%zu]: expected a finite number", i);
  const View<std::uint32_t> edge = view<std::uint32_t>(doc, "/network/edge");
  network.edge = edge.data();
  for (std::size_t i = 0; i < edge.rows(); i++)
    if (edge[i] >= network.nodes)
      fail(CONCEG_E_RANGE, "/network/edge[%zu]: expected a node below %zu, got %u", i, network.nodes,
           edge[i]);
  network.edge_offset = offsets(doc, "/network/edge_offset", network.nodes, edge.rows()).data();
  if (has(doc, "/network/edge_shift")) {
    const View<std::int8_t> shift = view<std::int8_t>(doc, "/network/edge_shift", 3);
    same_rows("/network/edge_shift", shift.rows(), "/network/edge", edge.rows());
    network.edge_shift = shift.data();
    for (std::size_t i = 0; i < 3 * shift.rows(); i++)
      if (shift[i] && !input.box.periodic[i % 3])
        fail(CONCEG_E_RANGE, "/network/edge_shift[%zu]: expected 0 on the open axis %zu, got %d", i / 3,
             i % 3, shift[i]);
  }
}

void read_cells(conceg_doc *doc, Input &input) {
  Cells &cells = input.cells;
  const View<std::uint64_t> id = view<std::uint64_t>(doc, "/cells/id");
  const View<double> soma = view<double>(doc, "/cells/soma", 3);
  const View<float> radius = view<float>(doc, "/cells/radius");
  cells.count = id.rows(), cells.id = id.data(), cells.soma = soma.data(), cells.radius = radius.data();
  same_rows("/cells/soma", soma.rows(), "/cells/id", cells.count);
  same_rows("/cells/radius", radius.rows(), "/cells/id", cells.count);
  all_finite("/cells/soma", cells.soma, 3 * cells.count);
  for (std::size_t i = 0; i < cells.count; i++) {
    if (!(cells.radius[i] >= 0.0f && cells.radius[i] < 1e4f))
      fail(CONCEG_E_RANGE, "/cells/radius[%zu]: expected 0 or a soma radius in um, got %g", i,
           static_cast<double>(cells.radius[i]));
    for (int a = 0; a < 3; a++)
      if (2.0 * cells.radius[i] > conceg_box_side(&input.box, a))
        fail(CONCEG_E_RANGE,
             "/cells/radius[%zu]: expected a soma that fits the box of %g um on axis %d, got a radius of %g "
             "um",
             i, conceg_box_side(&input.box, a), a, static_cast<double>(cells.radius[i]));
    for (int a = 0; a < 3; a++)
      if (cells.soma[3 * i + a] < input.box.lo[a] || cells.soma[3 * i + a] > input.box.hi[a])
        fail(CONCEG_E_RANGE, "/cells/soma[%zu]: expected a soma in the box, got %g on axis %d", i,
             cells.soma[3 * i + a], a);
  }
}

// Roots first: each tree of a cell has one root bar, and a parent stands before its children in the same
// tree.
void check_family(const Bars &bars, std::size_t cell) {
  const std::uint64_t first = bars.cell_offset[cell], rows = bars.cell_offset[cell + 1] - first;
  std::vector<std::uint8_t> rooted;
  for (std::uint64_t row = 0; row < rows; row++) {
    const std::uint64_t bar = first + row;
    const std::int64_t parent = bars.parent[bar];
    const std::uint32_t tree = bars.tree[bar];
    if (tree >= rows)
      fail(CONCEG_E_RANGE, "/bars/tree[%llu]: expected less than the cell's %llu bars, got %u",
           static_cast<unsigned long long>(bar), static_cast<unsigned long long>(rows), tree);
    if (parent < -1 || parent >= static_cast<std::int64_t>(row) ||
        (parent >= 0 && bars.tree[first + static_cast<std::uint64_t>(parent)] != tree))
      fail(CONCEG_E_RANGE, "/bars/parent[%llu]: expected -1 or an earlier row of the same tree, got %lld",
           static_cast<unsigned long long>(bar), static_cast<long long>(parent));
    if (rooted.size() <= tree) rooted.resize(tree + 1, 0);
    if (parent >= 0) continue;
    if (rooted[tree])
      fail(CONCEG_E_RANGE, "/bars/parent[%llu]: expected one root bar in tree %u, got a second one",
           static_cast<unsigned long long>(bar), tree);
    rooted[tree] = 1;
  }
}

void read_bars(conceg_doc *doc, Input &input) {
  Bars &bars = input.bars;
  const View<std::uint32_t> tree = view<std::uint32_t>(doc, "/bars/tree");
  const std::size_t count = tree.rows();
  if (count >= none) fail(CONCEG_E_RANGE, "/bars/tree: expected fewer than 2^32 - 1 bars, got %zu", count);
  bars.count = count, bars.tree = tree.data();
  bars.cell_offset = offsets(doc, "/bars/cell_offset", input.cells.count, count).data();
  const View<std::int64_t> parent = view<std::int64_t>(doc, "/bars/parent");
  const View<std::uint8_t> neurite = view<std::uint8_t>(doc, "/bars/neurite");
  same_rows("/bars/parent", parent.rows(), "/bars/tree", count);
  same_rows("/bars/neurite", neurite.rows(), "/bars/tree", count);
  bars.parent = parent.data(), bars.neurite = neurite.data();
  bars.asked_start = column(doc, "/bars/asked_start", count),
  bars.asked_end = column(doc, "/bars/asked_end", count);
  bars.attractor = column(doc, "/bars/attractor", count, 3), bars.angle = column(doc, "/bars/angle", count);
  bars.radius = column(doc, "/bars/radius", count), bars.taper = column(doc, "/bars/taper", count);
  bars.radius_floor = column(doc, "/bars/radius_floor", count);
  for (std::size_t i = 0; i < count; i++) {
    if (!(bars.asked_start[i] >= 0.0 && bars.asked_end[i] > bars.asked_start[i] && bars.asked_end[i] < 1e5))
      fail(CONCEG_E_RANGE, "/bars/asked_end[%zu]: expected 0 <= start < end < 100 mm, got %g and %g um", i,
           bars.asked_start[i], bars.asked_end[i]);
    if (!(bars.radius[i] > 0.0 && bars.radius[i] < 100.0 && bars.radius_floor[i] > 0.0 &&
          bars.radius_floor[i] < 100.0))
      fail(CONCEG_E_RANGE,
           "/bars/radius[%zu]: expected a radius and floor above 0 and below 100 um, got %g and %g", i,
           bars.radius[i], bars.radius_floor[i]);
  }
  for (std::size_t cell = 0; cell < input.cells.count; cell++)
    check_family(bars, cell);
}

// As far from the box as a bar is long at most, so that lifts stay small.
void check_places(const Input &input) {
  const Earlier &earlier = input.earlier;
  constexpr double farthest_um = 1e5;
  for (std::size_t i = 0; i < 3 * earlier.rows; i++) {
    const double place = earlier.position[i], low = input.box.lo[i % 3], high = input.box.hi[i % 3];
    if (!(place > low - farthest_um && place < high + farthest_um))
      fail(CONCEG_E_RANGE,
           "/skeleton/position[%zu]: expected a place within 100 mm of the box, got %g on axis %zu", i / 3,
           place, i % 3);
  }
}

// Bars end where they were asked to, at the farthest.
void check_achieved(const Input &input) {
  constexpr double beyond_um = 1e-3; // as growth ends a bar
  for (std::size_t i = 0; i < input.bars.count; i++) {
    const double start = input.earlier.achieved_start[i], end = input.earlier.achieved_end[i];
    if (!(start >= 0.0 && end >= start && end <= input.bars.asked_end[i] + beyond_um))
      fail(CONCEG_E_RANGE,
           "/bars/achieved_end[%zu]: expected 0 <= start <= end <= %g um as asked, got %g and %g um", i,
           input.bars.asked_end[i], start, end);
  }
}

void check_radii(const Earlier &earlier) {
  for (std::size_t i = 0; i < earlier.rows; i++)
    if (!(earlier.radius[i] > 0.0f && earlier.radius[i] < 100.0f))
      fail(CONCEG_E_RANGE, "/skeleton/radius[%zu]: expected a radius above 0 and below 100 um, got %g", i,
           static_cast<double>(earlier.radius[i]));
  for (std::size_t i = 0; i < earlier.rows; i++)
    if (!(earlier.target_radius[i] > 0.0f && earlier.target_radius[i] < 100.0f))
      fail(CONCEG_E_RANGE, "/skeleton/target_radius[%zu]: expected a radius above 0 and below 100 um, got %g",
           i, static_cast<double>(earlier.target_radius[i]));
}

// Each point continues the line of its bar, or starts it on a point of another bar.
void check_lines(const Input &input) {
  const Earlier &earlier = input.earlier;
  for (std::size_t cell = 0; cell < input.cells.count; cell++) {
    const std::uint64_t first = earlier.cell_offset[cell];
    const std::uint64_t bars = input.bars.cell_offset[cell + 1] - input.bars.cell_offset[cell];
    std::vector<std::uint8_t> begun(bars, 0);
    for (std::uint64_t row = 0; row < earlier.cell_offset[cell + 1] - first; row++) {
      const std::uint32_t bar = earlier.bar[first + row];
      const std::int64_t parent = earlier.parent[first + row];
      const auto at = static_cast<unsigned long long>(first + row);
      if (bar >= bars)
        fail(CONCEG_E_RANGE, "/skeleton/bar[%llu]: expected a bar below %llu, got %u", at,
             static_cast<unsigned long long>(bars), bar);
      if (parent < -1 || parent >= static_cast<std::int64_t>(row))
        fail(CONCEG_E_RANGE, "/skeleton/parent[%llu]: expected -1 or an earlier row of the cell, got %lld",
             at, static_cast<long long>(parent));
      const bool goes_on = begun[bar] && row > 0 && earlier.bar[first + row - 1] == bar &&
                           parent == static_cast<std::int64_t>(row) - 1;
      const bool starts =
          !begun[bar] && (parent < 0 || earlier.bar[first + static_cast<std::uint64_t>(parent)] != bar);
      if (!goes_on && !starts)
        fail(CONCEG_E_RANGE,
             "/skeleton/bar[%llu]: expected the points of each bar in one line of rows, as conceg grow "
             "writes them; "
             "grow.finish carries on its skeletons only",
             at);
      begun[bar] = 1;
    }
  }
}

} // namespace

void read_earlier(conceg_doc *doc, Input &input) {
  if (!has(doc, "/skeleton/position")) return;
  Earlier &earlier = input.earlier;
  const View<double> position = view<double>(doc, "/skeleton/position", 3);
  const std::size_t rows = position.rows();
  const View<float> radius = view<float>(doc, "/skeleton/radius");
  const View<float> target = view<float>(doc, "/skeleton/target_radius");
  const View<std::int64_t> parent = view<std::int64_t>(doc, "/skeleton/parent");
  const View<std::uint32_t> bar = view<std::uint32_t>(doc, "/skeleton/bar");
  same_rows("/skeleton/radius", radius.rows(), "/skeleton/position", rows);
  same_rows("/skeleton/target_radius", target.rows(), "/skeleton/position", rows);
  same_rows("/skeleton/parent", parent.rows(), "/skeleton/position", rows);
  same_rows("/skeleton/bar", bar.rows(), "/skeleton/position", rows);
  earlier.rows = rows, earlier.position = position.data(), earlier.radius = radius.data(),
  earlier.target_radius = target.data();
  earlier.parent = parent.data(), earlier.bar = bar.data();
  earlier.cell_offset = offsets(doc, "/skeleton/cell_offset", input.cells.count, rows).data();
  earlier.achieved_start = column(doc, "/bars/achieved_start", input.bars.count);
  earlier.achieved_end = column(doc, "/bars/achieved_end", input.bars.count);
  check_places(input);
  check_radii(earlier);
  check_achieved(input);
  check_lines(input);
}

void check_spacing(const Input &input, double max_edge_um) {
  const Network &network = input.network;
  const std::size_t looked_at = 100000, stride = 1 + network.nodes / looked_at;
  std::size_t nodes = 0, edges = 0;
  for (std::size_t node = 0; node < network.nodes; node += stride, nodes++)
    for (std::uint64_t e = network.edge_offset[node]; e < network.edge_offset[node + 1]; e++) {
      glm::dvec3 along = network.at(network.edge[e]) - network.at(static_cast<std::uint32_t>(node));
      for (int a = 0; a < 3; a++)
        along[a] = conceg_box_nearest(&input.box, a, along[a]);
      edges += glm::length(along) <= max_edge_um;
    }
  const double each = static_cast<double>(edges) / static_cast<double>(nodes);
  if (each < least_choices)
    fail(CONCEG_E_RANGE,
         "/network: expected %g edges up to max_edge_um = %g um at a node on average, got %.2f: the nodes "
         "are too sparse; raise "
         "density_per_um3 of triangulate, or max_edge_um",
         least_choices, max_edge_um, each);
}

Input read_input(conceg_doc *doc, std::uint64_t seed) {
  Input input;
  input.seed = seed;
  read_box(doc, input);
  read_network(doc, input);
  read_cells(doc, input);
  read_bars(doc, input);
  return input;
}

} // namespace conceg::grow
