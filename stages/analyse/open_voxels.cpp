// SPDX-License-Identifier: BSD-3-Clause
#include "open_voxels.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace conceg::analyse {

double largest_spacing(const OpenVoxels &v) {
  return std::max({v.spacing[0], v.spacing[1], v.spacing[2]});
}

double open_fraction(const OpenVoxels &v) {
  std::uint64_t open = 0;
  for (const std::uint8_t o : v.open)
    open += o;
  return v.open.empty() ? 0 : static_cast<double>(open) / static_cast<double>(v.open.size());
}

bool isotropic(const OpenVoxels &v) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t a = 0; a < 3; a++)
    if (v.shape[a] > 1) least = std::min(least, v.spacing[a]), most = std::max(most, v.spacing[a]);
  return most <= 1.1 * least;
}

OpenVoxels coarser(const OpenVoxels &voxels) {
  OpenVoxels out = {{}, {}, {}, voxels.periodic};
  const auto [nx, ny, nz] = voxels.shape;
  out.shape = {nx / 2, ny / 2, nz / 2};
  for (std::size_t a = 0; a < 3; a++)
    out.spacing[a] = 2 * voxels.spacing[a];
  for (std::size_t x = 0; x < nx / 2; x++)
    for (std::size_t y = 0; y < ny / 2; y++)
      for (std::size_t z = 0; z < nz / 2; z++) {
        int open = 0;
        for (std::size_t n = 0; n < 8; n++)
          open += voxels.open[((2 * x + n / 4) * ny + 2 * y + n / 2 % 2) * nz + 2 * z + n % 2];
        const std::uint8_t lowest = voxels.open[(2 * x * ny + 2 * y) * nz + 2 * z];
        out.open.push_back(open == 4 ? lowest : open > 4);
      }
  return out;
}

OpenVoxels section(const OpenVoxels &voxels, std::size_t axis, std::size_t at) {
  OpenVoxels out = {voxels.shape, {}, voxels.spacing, voxels.periodic};
  out.shape[axis] = 1;
  const auto [nx, ny, nz] = voxels.shape;
  std::array<std::size_t, 3> lo = {0, 0, 0}, hi = {nx, ny, nz};
  lo[axis] = at, hi[axis] = at + 1;
  for (std::size_t x = lo[0]; x < hi[0]; x++)
    for (std::size_t y = lo[1]; y < hi[1]; y++)
      for (std::size_t z = lo[2]; z < hi[2]; z++)
        out.open.push_back(voxels.open[(x * ny + y) * nz + z]);
  return out;
}

OpenPieces open_pieces(const OpenVoxels &voxels) {
  const Steps steps(voxels, Steps::around(voxels, 1), 1);
  std::vector<std::uint8_t> seen(voxels.open.size(), 0);
  std::vector<std::uint32_t> todo;
  OpenPieces out;
  std::uint64_t all = 0, largest = 0;
  for (std::size_t start = 0; start < voxels.open.size(); start++) {
    if (!voxels.open[start] || seen[start]) continue;
    std::uint64_t size = 0;
    todo.assign(1, static_cast<std::uint32_t>(start)), seen[start] = 1;
    while (!todo.empty()) {
      const std::size_t i = todo.back();
      todo.pop_back(), size++;
      steps.from(i, [&](std::size_t j, std::size_t) {
        if (!voxels.open[j] || seen[j]) return;
        seen[j] = 1;
        todo.push_back(static_cast<std::uint32_t>(j));
      });
    }
    out.pieces++, all += size, largest = std::max(largest, size);
  }
  if (all) out.largest = static_cast<double>(largest) / static_cast<double>(all);
  return out;
}

Steps::Steps(const OpenVoxels &voxels, std::vector<Step> steps, long reach)
    : shape_(voxels.shape), periodic_(voxels.periodic), step_(std::move(steps)) {
  const auto [nx, ny, nz] = shape_;
  for (const Step &by : step_) {
    double squared = 0;
    for (std::size_t a = 0; a < 3; a++)
      squared += std::pow(static_cast<double>(by[a]) * voxels.spacing[a], 2);
    length_.push_back(std::sqrt(squared));
    offset_.push_back((by[0] * static_cast<long>(ny) + by[1]) * static_cast<long>(nz) + by[2]);
  }
  near_face_.assign(nx * ny * nz, 0);
  const auto is_near = [&](std::size_t a, std::size_t at) {
    const auto far = static_cast<std::size_t>(reach);
    return shape_[a] > 1 && (at < far || at + far >= shape_[a]);
  };
  for (std::size_t x = 0; x < nx; x++)
    for (std::size_t y = 0; y < ny; y++)
      for (std::size_t z = 0; z < nz; z++)
        near_face_[(x * ny + y) * nz + z] = is_near(0, x) || is_near(1, y) || is_near(2, z);
}

std::vector<Steps::Step> Steps::around(const OpenVoxels &voxels, long most_axes) {
  std::vector<Step> out;
  const auto reach = [&](std::size_t a) { return voxels.shape[a] > 1 ? 1L : 0L; };
  for (long x = -reach(0); x <= reach(0); x++)
    for (long y = -reach(1); y <= reach(1); y++)
      for (long z = -reach(2); z <= reach(2); z++) {
        const long axes = std::abs(x) + std::abs(y) + std::abs(z);
        if (axes > 0 && axes <= most_axes) out.push_back({x, y, z});
      }
  return out;
}

std::size_t Steps::over_faces(std::size_t i, const Step &by) const {
  const std::size_t row = i / shape_[2], x = row / shape_[1];
  const std::array<std::size_t, 3> at = {x, row - x * shape_[1], i - row * shape_[2]};
  std::array<std::size_t, 3> q = {};
  for (std::size_t a = 0; a < 3; a++) {
    const auto n = static_cast<long>(shape_[a]);
    long to = static_cast<long>(at[a]) + by[a];
    if (to < 0 || to >= n) {
      if (!periodic_[a]) return outside;
      to = ((to % n) + n) % n;
    }
    q[a] = static_cast<std::size_t>(to);
  }
  return (q[0] * shape_[1] + q[1]) * shape_[2] + q[2];
}

} // namespace conceg::analyse
