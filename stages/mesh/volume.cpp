// SPDX-License-Identifier: BSD-3-Clause
#include "volume.hpp"

#include <algorithm>
#include <atomic>

namespace conceg::mesh {
namespace {

struct Leaf {
  glm::ivec3 origin{};
  std::uint32_t label[kLeafVoxels];
  float distance[kLeafVoxels];
};

// Fills one leaf from a block; false when every voxel is outside the cells and beyond the band.
bool fill_leaf(const BlockField &field, const glm::ivec3 &corner, const glm::ivec3 &shape, float band,
               float unit, Leaf &leaf) {
  bool holds = false;
  leaf.origin = field.first + kHalo + corner;
  std::fill(leaf.label, leaf.label + kLeafVoxels, 0u);
  std::fill(leaf.distance, leaf.distance + kLeafVoxels, band * unit);
  for (int x = 0, voxel = 0; x < kLeaf; x++)
    for (int y = 0; y < kLeaf; y++)
      for (int z = 0; z < kLeaf; z++, voxel++) {
        const glm::ivec3 at = leaf.origin + glm::ivec3(x, y, z);
        if (at.x >= shape.x || at.y >= shape.y || at.z >= shape.z) continue;
        const int node = ((corner.z + z + kHalo) * kRow + corner.y + y + kHalo) * kRow + corner.x + x + kHalo;
        float nearest = band;
        for (std::size_t label = 0; label < field.label.size(); label++) {
          const float value = field.of(label)[node];
          if (value < 0) leaf.label[voxel] = field.label[label].cell + 1;
          nearest = std::min(nearest, value);
        }
        holds |= nearest < band;
        leaf.distance[voxel] = std::max(-band, nearest) * unit;
      }
  return holds;
}

} // namespace

Volume make_volume(const Tissue &tissue, SceneOptions options, Workers &workers, const Progress &progress) {
  options.centred = true;
  const Scene scene = make_scene(tissue, options);
  const Index index = make_index(scene, workers, progress);
  constexpr float band = 2.0f; // steps; what the field is exact in
  std::vector<std::vector<Leaf>> blocks(index.block.size());
  std::atomic<std::uint64_t> done{0};
  workers.loop(blocks.size(), 1, [&](std::size_t row, unsigned) {
    static thread_local BlockField field;
    evaluate_block(scene, index, row, field);
    Leaf leaf;
    for (int x = 0; x < kBlock; x += kLeaf)
      for (int y = 0; y < kBlock; y += kLeaf)
        for (int z = 0; z < kBlock; z += kLeaf)
          if (fill_leaf(field, {x, y, z}, scene.grid.size, band, static_cast<float>(scene.grid.unit), leaf))
            blocks[row].push_back(leaf);
    const std::uint64_t count = ++done;
    if (count % 64 == 0) report(progress, "mesh: volume", count, blocks.size());
  });
  Volume volume;
  volume.origin = scene.grid.origin, volume.spacing = scene.grid.step, volume.shape = scene.grid.size;
  volume.band = band * scene.grid.unit;
  for (auto &block : blocks) {
    for (const Leaf &leaf : block) {
      volume.leaf_origin.push_back(leaf.origin);
      volume.label.insert(volume.label.end(), leaf.label, leaf.label + kLeafVoxels);
      volume.distance.insert(volume.distance.end(), leaf.distance, leaf.distance + kLeafVoxels);
    }
    block = {};
  }
  return volume;
}

} // namespace conceg::mesh
