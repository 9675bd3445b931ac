// SPDX-License-Identifier: BSD-3-Clause
#include "field.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace conceg::analyse {

namespace {

constexpr int leaf_side = 8;
constexpr std::size_t leaf_voxels = 512;

// Is the point inside the cell's soma sphere or one of its images?
bool in_soma(const Cells &cells, std::size_t cell, const conceg_box &box, const glm::dvec3 &p) {
  glm::dvec3 from = p - cells.soma[cell];
  for (int a = 0; a < 3; a++)
    if (box.periodic[a]) {
      const double length = conceg_box_side(&box, a);
      from[a] -= length * std::round(from[a] / length);
    }
  const double radius = cells.soma_radius[cell];
  return glm::dot(from, from) < radius * radius;
}

} // namespace

void check(const LabelVolume &volume, const Cells &cells, const conceg_box &box) {
  for (int a = 0; a < 3; a++) {
    const double length = volume.spacing[a] * static_cast<double>(volume.shape[a]);
    if (!(std::abs(length - conceg_box_side(&box, a)) <= 1e-6 * length))
      fail(CONCEG_E_FORMAT, "/volumes@shape[%d]: expected voxels that fill the box of %g um, got %g um", a,
           conceg_box_side(&box, a), length);
  }
  for (std::size_t i = 0; i < volume.leaves; i++)
    for (int a = 0; a < 3; a++) {
      const std::int64_t first = volume.leaf_origin[3 * i + static_cast<std::size_t>(a)];
      if (first < 0 || first % leaf_side || first >= static_cast<std::int64_t>(volume.shape[a]))
        fail(CONCEG_E_FORMAT, "/volumes/leaf_origin[%zu]: expected multiples of 8 within the box, got %lld",
             i, static_cast<long long>(first));
    }
  for (std::size_t i = 0; i < volume.leaves * leaf_voxels; i++)
    if (volume.label[i] > cells.type.size())
      fail(CONCEG_E_FORMAT, "/volumes/label[%zu]: expected at most %zu, got %u", i / leaf_voxels,
           cells.type.size(), volume.label[i]);
}

FieldShares label_shares(const LabelVolume &volume, const Cells &cells, const conceg_box &box,
                         Workers &workers) {
  std::vector<std::array<std::uint32_t, 2>> counts(volume.leaves, {0, 0}); // soma, neurite
  workers.loop(volume.leaves, 64, [&](std::size_t i, unsigned) {
    const std::uint32_t *label = volume.label + i * leaf_voxels;
    const glm::ivec3 first(volume.leaf_origin[3 * i], volume.leaf_origin[3 * i + 1],
                           volume.leaf_origin[3 * i + 2]);
    for (int voxel = 0; voxel < static_cast<int>(leaf_voxels); voxel++) {
      if (!label[voxel]) continue;
      const glm::ivec3 at = first + glm::ivec3(voxel / 64, voxel / 8 % 8, voxel % 8);
      const bool soma =
          in_soma(cells, label[voxel] - 1, box, volume.origin + glm::dvec3(at) * volume.spacing);
      counts[i][soma ? 0 : 1]++;
    }
  });
  std::uint64_t soma = 0, neurite = 0;
  for (const auto &c : counts)
    soma += c[0], neurite += c[1];
  FieldShares shares;
  shares.voxels = volume.shape[0] * volume.shape[1] * volume.shape[2];
  shares.soma = static_cast<double>(soma) / static_cast<double>(shares.voxels);
  shares.neurite = static_cast<double>(neurite) / static_cast<double>(shares.voxels);
  return shares;
}

} // namespace conceg::analyse
