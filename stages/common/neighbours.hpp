// SPDX-License-Identifier: BSD-3-Clause
// A uniform grid over the box, periodic where the box is: what lies near a point is in its cell and the cells
// around it.
#pragma once

#include "wrap.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace conceg {

class NeighbourGrid {
public:
  // Cells at least `reach_um` wide, at most about four million of them.
  NeighbourGrid(const conceg_box &box, double reach_um) : box_(box) {
    const double most = 4.0 * 1024 * 1024;
    const double width = std::max(reach_um, conceg_pow(volume(box) / most, 1.0 / 3.0));
    for (int axis = 0; axis < 3; axis++)
      count_[axis] = std::max(1, static_cast<int>(std::min(conceg_box_side(&box, axis) / width, most)));
    cells_.resize(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]);
  }

  void add(const glm::dvec3 &point, std::uint32_t item) { cells_[index(cell_of(point))].push_back(item); }

  // visit(item) for every item that may lie within the reach of a point; stops when it returns false.
  template <class Visit> void around(const glm::dvec3 &point, Visit &&visit) const {
    const std::array<int, 3> cell = cell_of(point);
    std::array<std::array<int, 3>, 3> near;
    std::array<int, 3> many;
    for (int axis = 0; axis < 3; axis++)
      many[axis] = around_on(axis, cell[axis], near[axis]);
    for (int x = 0; x < many[0]; x++)
      for (int y = 0; y < many[1]; y++)
        for (int z = 0; z < many[2]; z++)
          for (const std::uint32_t item : cells_[index({near[0][x], near[1][y], near[2][z]})])
            if (!visit(item)) return;
  }

private:
  std::array<int, 3> cell_of(const glm::dvec3 &point) const {
    std::array<int, 3> cell;
    for (int axis = 0; axis < 3; axis++) {
      const double at = (conceg_box_wrap(&box_, axis, point[axis]) - box_.lo[axis]) /
                        conceg_box_side(&box_, axis) * count_[axis];
      cell[axis] = std::clamp(static_cast<int>(at), 0, count_[axis] - 1);
    }
    return cell;
  }
  std::size_t index(const std::array<int, 3> &cell) const {
    return (static_cast<std::size_t>(cell[0]) * count_[1] + cell[1]) * count_[2] + cell[2];
  }
  // The different cells next to `cell` on one axis, itself included.
  int around_on(int axis, int cell, std::array<int, 3> &out) const {
    int many = 0;
    for (int step = -1; step <= 1; step++) {
      int at = cell + step;
      if (box_.periodic[axis]) at = (at + count_[axis]) % count_[axis];
      if (at >= 0 && at < count_[axis] &&
          std::find(out.begin(), out.begin() + many, at) == out.begin() + many)
        out[many++] = at;
    }
    return many;
  }

  conceg_box box_;
  std::array<int, 3> count_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

} // namespace conceg
