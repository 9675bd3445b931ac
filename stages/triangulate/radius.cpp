// SPDX-License-Identifier: GPL-3.0-or-later
#include "radius.hpp"

#include "conceg/portable.h"
#include "wrap.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace conceg::triangulate {
namespace {

constexpr std::size_t kBlock = 4096;                // nodes between two progress reports
constexpr double kGridCells = 16 * 1024.0 * 1024.0; // most cells of the grid of somas

// Somas in a grid of cells at least as wide as their reach (radius + cap), so that 27 cells hold all that
// matter.
class SomaGrid {
public:
  SomaGrid(const conceg_box &box, const std::vector<Soma> &somas, double cap_um) : box_(box), somas_(somas) {
    double reach = cap_um;
    for (const Soma &soma : somas)
      reach = std::max(reach, soma.radius + cap_um);
    const double width = std::max(reach, conceg_pow(volume(box) / kGridCells, 1.0 / 3.0));
    for (int axis = 0; axis < 3; axis++) {
      const double cells = std::floor(conceg_box_side(&box, axis) / width);
      count_[axis] = std::max(1, static_cast<int>(std::min(cells, kGridCells)));
    }
    cells_.resize(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]);
    for (std::size_t i = 0; i < somas.size(); i++)
      if (somas[i].radius > 0.0)
        cells_[index(cell_of(somas[i].center))].push_back(static_cast<std::uint32_t>(i));
  }

  double distance(const glm::dvec3 &p) const {
    double nearest_surface = HUGE_VAL;
    const glm::ivec3 center = cell_of(p);
    std::array<std::array<int, 3>, 3> around;
    std::array<int, 3> many;
    for (int axis = 0; axis < 3; axis++)
      many[axis] = around_on(axis, center[axis], around[axis]);
    for (int x = 0; x < many[0]; x++)
      for (int y = 0; y < many[1]; y++)
        for (int z = 0; z < many[2]; z++)
          for (const std::uint32_t i : cells_[index({around[0][x], around[1][y], around[2][z]})]) {
            const glm::dvec3 d = nearest(box_, p - somas_[i].center);
            nearest_surface =
                std::min(nearest_surface, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - somas_[i].radius);
          }
    return nearest_surface;
  }

private:
  glm::ivec3 cell_of(const glm::dvec3 &p) const {
    glm::ivec3 cell;
    for (int axis = 0; axis < 3; axis++) {
      const double at = (conceg_box_wrap(&box_, axis, p[axis]) - box_.lo[axis]) /
                        conceg_box_side(&box_, axis) * count_[axis];
      cell[axis] = std::clamp(static_cast<int>(at), 0, count_[axis] - 1);
    }
    return cell;
  }
  std::size_t index(const glm::ivec3 &cell) const {
    return (static_cast<std::size_t>(cell.x) * count_[1] + cell.y) * count_[2] + cell.z;
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

  const conceg_box &box_;
  const std::vector<Soma> &somas_;
  std::array<int, 3> count_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

} // namespace

std::vector<float> allowed_radii(const conceg_box &box, const std::vector<glm::dvec3> &nodes,
                                 const std::vector<Soma> &somas, double cap_um, Workers &workers,
                                 const Progress &progress) {
  const SomaGrid grid(box, somas, cap_um);
  std::vector<float> radii(nodes.size());
  std::atomic<std::uint64_t> done{0};
  workers.loop((nodes.size() + kBlock - 1) / kBlock, 1, [&](std::size_t block, unsigned) {
    const std::size_t end = std::min(nodes.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; i++) {
      double radius = std::min(cap_um, grid.distance(nodes[i]));
      for (int axis = 0; axis < 3; axis++)
        if (!box.periodic[axis])
          radius = std::min({radius, nodes[i][axis] - box.lo[axis], box.hi[axis] - nodes[i][axis]});
      radii[i] = static_cast<float>(radius);
    }
    report(progress, "largest radii", done += end - block * kBlock, nodes.size());
  });
  return radii;
}

} // namespace conceg::triangulate
