// SPDX-License-Identifier: BSD-3-Clause
#include "pores.hpp"

#include <algorithm>

namespace conceg::analyse {

namespace {

constexpr std::size_t leaf_voxels = 512;

bool in_box(const LabelVolume &volume, std::size_t leaf, std::size_t voxel) {
  const std::size_t at[3] = {voxel / 64, voxel / 8 % 8, voxel % 8};
  for (std::size_t a = 0; a < 3; a++)
    if (static_cast<std::uint64_t>(volume.leaf_origin[3 * leaf + a]) + at[a] >= volume.shape[a]) return false;
  return true;
}

} // namespace

Pores pore_sizes(const LabelVolume &volume, const float *distance, Workers &workers) {
  std::vector<std::vector<float>> of_leaf(volume.leaves);
  std::vector<std::uint32_t> seen(volume.leaves, 0);
  workers.loop(volume.leaves, 64, [&](std::size_t i, unsigned) {
    for (std::size_t voxel = 0; voxel < leaf_voxels; voxel++) {
      if (!in_box(volume, i, voxel)) continue;
      seen[i]++;
      if (!volume.label[i * leaf_voxels + voxel]) of_leaf[i].push_back(distance[i * leaf_voxels + voxel]);
    }
  });
  float band = 0;
  std::uint64_t left_out = volume.shape[0] * volume.shape[1] * volume.shape[2];
  std::vector<float> all;
  for (std::size_t i = 0; i < volume.leaves; i++) {
    all.insert(all.end(), of_leaf[i].begin(), of_leaf[i].end());
    left_out -= seen[i];
  }
  for (std::size_t i = 0; i < volume.leaves * leaf_voxels; i++)
    band = std::max(band, distance[i]);
  Pores pores;
  pores.voxels = all.size() + left_out;
  if (!pores.voxels) return pores;
  std::sort(all.begin(), all.end());
  double sum = static_cast<double>(left_out) * band;
  std::uint64_t beyond = left_out;
  for (const float d : all)
    sum += d, beyond += d >= band;
  const auto count = static_cast<double>(pores.voxels);
  const auto quantile = [&](double share) {
    const auto at = static_cast<std::uint64_t>(share * (count - 1));
    return static_cast<double>(at < all.size() ? all[at] : band);
  };
  pores.mean = sum / count, pores.beyond = static_cast<double>(beyond) / count;
  pores.median = quantile(0.5), pores.p95 = quantile(0.95);
  return pores;
}

} // namespace conceg::analyse
