// SPDX-License-Identifier: BSD-3-Clause
// Occupancy of space: the grid of committed capsules, and the nodes' field of free radius that follows it.
#pragma once

#include "state.hpp"

namespace conceg::grow {

// Grid, buckets of nodes, somas and other obstacles.
void make_space(State &state);

// A grid over the box with cells of `step_um` or a little more.
Grid make_grid(const conceg_box &box, double step_um);

// Grid cells that a region touches along one axis.
struct GridRange {
  int first, number;
};
inline GridRange grid_range(const Grid &grid, const Region &region, int axis) {
  int lo = static_cast<int>(__builtin_floor((region.lo[axis] - grid.lo[axis]) / grid.step[axis]));
  int hi = static_cast<int>(__builtin_floor((region.hi[axis] - grid.lo[axis]) / grid.step[axis]));
  const int n = grid.count[axis];
  if (grid.periodic[axis]) {
    const int first = lo % n;
    return {first < 0 ? first + n : first, hi - lo + 1 < n ? hi - lo + 1 : n};
  }
  lo = lo < 0 ? 0 : lo >= n ? n - 1 : lo;
  hi = hi < 0 ? 0 : hi >= n ? n - 1 : hi;
  return {lo, hi - lo + 1};
}

// Calls visit(cell index, its place on each axis, whether it is the region's first there) for each grid cell
// that a region touches, each once.
template <class Visit> void for_grid_places(const Grid &grid, const Region &region, Visit &&visit) {
  const GridRange range[3] = {grid_range(grid, region, 0), grid_range(grid, region, 1),
                              grid_range(grid, region, 2)};
  int place[3];
  bool edge[3];
  const auto next = [&](int axis) { return place[axis] + 1 == grid.count[axis] ? 0 : place[axis] + 1; };
  place[0] = range[0].first;
  for (int i = 0; i < range[0].number; i++, place[0] = next(0)) {
    edge[0] = i == 0, place[1] = range[1].first;
    for (int j = 0; j < range[1].number; j++, place[1] = next(1)) {
      edge[1] = j == 0, place[2] = range[2].first;
      const std::size_t row = (static_cast<std::size_t>(place[0]) * grid.count[1] + place[1]) * grid.count[2];
      for (int k = 0; k < range[2].number; k++, place[2] = next(2)) {
        edge[2] = k == 0;
        visit(row + place[2], place, edge);
      }
    }
  }
}

// Calls visit(cell index) for each grid cell that a region touches, each once.
template <class Visit> void for_grid_cells(const Grid &grid, const Region &region, Visit &&visit) {
  for_grid_places(grid, region, [&](std::size_t cell, const int *, const bool *) { visit(cell); });
}

// The segment from a to b (unwrapped) of one bar, moved into the box.
Segment make_segment(const conceg_box &box, const glm::dvec3 &a, const glm::dvec3 &b, double radius,
                     std::uint32_t cell, std::uint32_t bar, double path_middle);
// Box of a segment with its radius and a margin.
Region region_of(const Segment &segment, double margin);

// Puts a segment into the capsule grid, or takes it out.
void insert_capsule(Space &space, std::uint32_t id);
void remove_capsule(Space &space, std::uint32_t id);

// Lowers the free radius around a segment.
void lower_field(const Input &input, Space &space, std::uint32_t id);
// Grows it back around segments that were taken out of the capsule grid.
void restore_field(const Input &input, Space &space, const std::vector<Segment> &removed);
// The field of one node from scratch.
NodeField fresh_field(const Input &input, const Space &space, std::uint32_t node);

// r_c: the largest radius allowed to `cell` at a node; `reach` or more = no limit known.
inline double allowed_radius(const NodeField &field, std::uint32_t cell) {
  return field.owner1 == cell ? field.distance2 : field.distance1;
}

// Path length along the tree between two places of one cell; stops counting beyond `limit`.
double tree_distance(const State &state, std::uint32_t bar1, double path1, std::uint32_t bar2, double path2,
                     double limit);

// The radius that fits around a segment, at most `want`: exact against every committed capsule and soma of
// other cells, of the cell's own images, and of the cell itself where it is not near along the tree. Below
// `need` = blocked.
double clearance(const State &state, const Segment &segment, double want, double need);

} // namespace conceg::grow
