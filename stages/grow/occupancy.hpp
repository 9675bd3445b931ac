// SPDX-License-Identifier: BSD-3-Clause
// Occupancy of space: the grid of committed capsules, and the nodes' field of free radius that follows it.
#pragma once

#include "state.hpp"

namespace conceg::grow {

// Grid, buckets of nodes, somas and other obstacles.
void make_space(State &state);

// Calls visit(cell index) for each grid cell that a region touches, each once.
template <class Visit> void for_grid_cells(const Grid &grid, const Region &region, Visit &&visit) {
  int first[3], number[3];
  for (int a = 0; a < 3; a++) {
    int lo = static_cast<int>(__builtin_floor((region.lo[a] - grid.lo[a]) / grid.step[a]));
    int hi = static_cast<int>(__builtin_floor((region.hi[a] - grid.lo[a]) / grid.step[a]));
    const int n = grid.count[a];
    if (grid.periodic[a]) {
      number[a] = hi - lo + 1 < n ? hi - lo + 1 : n;
      first[a] = lo % n;
      if (first[a] < 0) first[a] += n;
    } else {
      lo = lo < 0 ? 0 : lo >= n ? n - 1 : lo;
      hi = hi < 0 ? 0 : hi >= n ? n - 1 : hi;
      first[a] = lo, number[a] = hi - lo + 1;
    }
  }
  for (int i = 0, x = first[0]; i < number[0]; i++, x = x + 1 == grid.count[0] ? 0 : x + 1)
    for (int j = 0, y = first[1]; j < number[1]; j++, y = y + 1 == grid.count[1] ? 0 : y + 1)
      for (int k = 0, z = first[2]; k < number[2]; k++, z = z + 1 == grid.count[2] ? 0 : z + 1)
        visit((static_cast<std::size_t>(x) * grid.count[1] + y) * grid.count[2] + z);
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
