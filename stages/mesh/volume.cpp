// SPDX-License-Identifier: BSD-3-Clause
#include "volume.hpp"

#include <algorithm>
#include <atomic>

namespace conceg::mesh {
namespace {

constexpr int kLeavesOfBlock = (kBlock / kLeaf) * (kBlock / kLeaf) * (kBlock / kLeaf);

glm::ivec3 corner_of(int leaf) { // within its block
  constexpr int per_side = kBlock / kLeaf;
  return kLeaf * glm::ivec3(leaf / (per_side * per_side), leaf / per_side % per_side, leaf % per_side);
}

// body(voxel, node) for the voxels of a leaf that lie in the box.
template <class Body>
void for_each_voxel(const Scene &scene, const BlockField &field, const glm::ivec3 &corner, Body &&body) {
  const glm::ivec3 first = field.first + kHalo + corner, shape = scene.grid.size;
  for (int x = 0, voxel = 0; x < kLeaf; x++)
    for (int y = 0; y < kLeaf; y++)
      for (int z = 0; z < kLeaf; z++, voxel++)
        if (first.x + x < shape.x && first.y + y < shape.y && first.z + z < shape.z)
          body(voxel, ((corner.z + z + kHalo) * kRow + corner.y + y + kHalo) * kRow + corner.x + x + kHalo);
}

// Is some voxel of the leaf within the band or inside a cell? Before the separation, which only raises
// values: so no leaf that holds something is missed.
bool is_held(const Scene &scene, const BlockField &field, const glm::ivec3 &corner) {
  bool held = false;
  for_each_voxel(scene, field, corner, [&](int, int node) {
    held |= field.nearest[static_cast<std::size_t>(node)] < static_cast<float>(kVolumeBand);
  });
  return held;
}

void fill_leaf(const VolumeLayout &layout, const BlockField &field, const glm::ivec3 &corner,
               std::uint32_t *label, float *distance) {
  const Scene &scene = layout.scene;
  const float band = static_cast<float>(kVolumeBand), unit = static_cast<float>(scene.grid.unit);
  if (label) std::fill(label, label + kLeafVoxels, 0u);
  std::fill(distance, distance + kLeafVoxels, band * unit);
  for_each_voxel(scene, field, corner, [&](int voxel, int node) {
    float nearest = band;
    for (std::size_t i = 0; i < field.label.size(); i++) {
      const std::uint32_t cell = field.label[i].cell,
                          own = layout.label.empty() ? cell + 1 : layout.label[cell];
      const float value = field.of(i)[node];
      if (own == 0) continue;
      if (value < 0 && label) label[voxel] = own;
      nearest = std::min(nearest, value);
    }
    distance[voxel] = std::max(-band, nearest) * unit;
  });
}

// body(row, field) for every block of the index.
template <class Body>
void for_each_block(const Scene &scene, const Index &index, const char *what, Workers &workers,
                    const Progress &progress, Body &&body) {
  std::atomic<std::uint64_t> done{0};
  workers.loop(index.block.size(), 1, [&](std::size_t row, unsigned) {
    static thread_local BlockField field;
    evaluate_block(scene, index, row, field);
    body(row, field);
    const std::uint64_t count = ++done;
    if (count % 64 == 0) report(progress, what, count, index.block.size());
  });
}

} // namespace

VolumeLayout lay_out_volume(const Tissue &tissue, SceneOptions options, Workers &workers,
                            const Progress &progress, std::vector<std::uint32_t> label) {
  options.centred = true;
  VolumeLayout layout;
  layout.label = std::move(label);
  layout.scene = make_scene(tissue, options);
  layout.index = make_index(layout.scene, workers, progress);
  layout.band = kVolumeBand * layout.scene.grid.unit;
  const std::size_t blocks = layout.index.block.size();
  std::vector<std::uint8_t> held(blocks * kLeavesOfBlock, 0);
  std::vector<glm::ivec3> origin(blocks);
  for_each_block(layout.scene, layout.index, "mesh: leaves of the volume", workers, progress,
                 [&](std::size_t row, const BlockField &field) {
                   origin[row] = field.first + kHalo;
                   for (int leaf = 0; leaf < kLeavesOfBlock; leaf++)
                     held[row * kLeavesOfBlock + static_cast<std::size_t>(leaf)] =
                         is_held(layout.scene, field, corner_of(leaf));
                 });
  for (std::size_t row = 0; row < blocks; row++) {
    layout.first_leaf.push_back(layout.leaf_origin.size());
    for (int leaf = 0; leaf < kLeavesOfBlock; leaf++)
      if (held[row * kLeavesOfBlock + static_cast<std::size_t>(leaf)])
        layout.leaf_origin.push_back(origin[row] + corner_of(leaf));
  }
  layout.first_leaf.push_back(layout.leaf_origin.size());
  return layout;
}

void fill_volume(const VolumeLayout &layout, std::uint32_t *label, float *distance, Workers &workers,
                 const Progress &progress) {
  for_each_block(layout.scene, layout.index, "mesh: volume", workers, progress,
                 [&](std::size_t row, const BlockField &field) {
                   for (std::uint64_t i = layout.first_leaf[row]; i < layout.first_leaf[row + 1]; i++)
                     fill_leaf(layout, field, layout.leaf_origin[i] - field.first - kHalo,
                               label ? label + i * kLeafVoxels : nullptr, distance + i * kLeafVoxels);
                 });
}

} // namespace conceg::mesh
