// SPDX-License-Identifier: GPL-3.0-or-later
#include "levels.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::triangulate {
namespace {

// A cell's place along one axis, and the square of its centre's distance from a point along that axis.
struct Along {
  std::uint64_t index;
  double square;
};

// The cells along an axis whose centres may lie within the radius, each once.
std::vector<Along> cells_along(const Lattice &lattice, int axis, double center, double radius) {
  const double width = lattice.width(axis), lo = lattice.box.lo[axis];
  const auto count = static_cast<std::int64_t>(lattice.cells[axis]);
  const auto at = static_cast<std::int64_t>(std::floor((center - lo) / width));
  const auto reach = static_cast<std::int64_t>(std::ceil(radius / width));
  const bool periodic = lattice.box.periodic[axis] != 0;
  const std::int64_t first =
      periodic ? at - std::min(reach, (count - 1) / 2) : std::max<std::int64_t>(at - reach, 0);
  const std::int64_t last = periodic ? at + std::min(reach, count / 2) : std::min(at + reach, count - 1);
  std::vector<Along> cells;
  for (std::int64_t i = first; i <= last; i++) {
    const double middle = lo + width * (static_cast<double>(i) + 0.5);
    const double d = conceg_box_nearest(&lattice.box, axis, middle - center);
    cells.push_back({static_cast<std::uint64_t>((i % count + count) % count), d * d});
  }
  return cells;
}

// visit(cell) for every cell whose centre is at most `radius` from the nearest image of a point.
template <class Visit>
void each_cell_within(const Lattice &lattice, const glm::dvec3 &center, double radius, Visit &&visit) {
  if (!(radius >= 0.0)) return;
  std::array<std::vector<Along>, 3> along;
  for (int axis = 0; axis < 3; axis++)
    along[axis] = cells_along(lattice, axis, center[axis], radius);
  for (const Along &z : along[2])
    for (const Along &y : along[1])
      for (const Along &x : along[0])
        if (x.square + y.square + z.square <= radius * radius)
          visit(x.index + lattice.cells[0] * (y.index + lattice.cells[1] * z.index));
}

// The largest level of a cell and the two beside it, along one axis.
std::vector<std::uint8_t> largest_along(const Lattice &lattice, int axis,
                                        const std::vector<std::uint8_t> &levels) {
  std::uint64_t stride = 1;
  for (int a = 0; a < axis; a++)
    stride *= lattice.cells[a];
  const std::uint64_t count = lattice.cells[axis];
  const bool periodic = lattice.box.periodic[axis] != 0;
  std::vector<std::uint8_t> out(levels);
  for (std::uint64_t cell = 0; cell < levels.size(); cell++) {
    const std::uint64_t at = cell / stride % count, start = cell - at * stride;
    if (at > 0 || periodic)
      out[cell] = std::max(out[cell], levels[start + (at + count - 1) % count * stride]);
    if (at + 1 < count || periodic)
      out[cell] = std::max(out[cell], levels[start + (at + 1) % count * stride]);
  }
  return out;
}

void limit_steps(const Lattice &lattice, std::vector<std::uint8_t> &levels) {
  for (unsigned pass = 1; pass < kFinestLevel; pass++) { // each pass carries a level one cell further
    std::vector<std::uint8_t> largest = levels;
    for (int axis = 0; axis < 3; axis++)
      largest = largest_along(lattice, axis, largest);
    for (std::size_t cell = 0; cell < levels.size(); cell++)
      if (levels[cell] + 1 < largest[cell]) levels[cell] = static_cast<std::uint8_t>(largest[cell] - 1);
  }
}

} // namespace

std::vector<Zone> soma_zones(const std::vector<Soma> &somas, unsigned finest, double distance_um) {
  std::vector<Zone> zones;
  for (const Soma &soma : somas)
    for (unsigned level = finest; level > 0 && soma.radius > 0.0; level--)
      zones.push_back({soma.center, soma.radius + distance_um * (finest - level + 1), level});
  return zones;
}

std::vector<std::uint8_t> grade_levels(const Lattice &lattice, const std::vector<Zone> &zones,
                                       const std::vector<Soma> &somas) {
  std::vector<std::uint8_t> levels(lattice.count(), 0);
  for (const Zone &zone : zones)
    each_cell_within(lattice, zone.center, zone.radius_um, [&](std::uint64_t cell) {
      levels[cell] = std::max(levels[cell], static_cast<std::uint8_t>(zone.level));
    });
  const double half_diagonal =
      0.5 * std::sqrt(lattice.width(0) * lattice.width(0) + lattice.width(1) * lattice.width(1) +
                      lattice.width(2) * lattice.width(2));
  for (const Soma &soma : somas)
    each_cell_within(lattice, soma.center, soma.radius - half_diagonal,
                     [&](std::uint64_t cell) { levels[cell] = 0; });
  limit_steps(lattice, levels);
  return levels;
}

std::array<std::uint64_t, kFinestLevel + 1> nodes_by_level(const std::vector<std::uint8_t> &levels) {
  std::array<std::uint64_t, kFinestLevel + 1> nodes{};
  for (const std::uint8_t level : levels)
    nodes[level] += nodes_in_cell(level);
  return nodes;
}

} // namespace conceg::triangulate
