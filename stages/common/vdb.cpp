// SPDX-License-Identifier: BSD-3-Clause
// The only file that knows OpenVDB.
#include "vdb.hpp"

#include "output.hpp"

#include <openvdb/openvdb.h>

namespace conceg {
namespace {

constexpr int leaf_voxels = 512;

openvdb::math::Transform::Ptr transform_of(const LeafVolume &volume) {
  auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  transform->preScale(openvdb::Vec3d(volume.spacing.x, volume.spacing.y, volume.spacing.z));
  transform->postTranslate(openvdb::Vec3d(volume.origin.x, volume.origin.y, volume.origin.z));
  return transform;
}

// Copies leaves whose voxels are stored in the same order as OpenVDB's.
template <class Grid, class Value>
typename Grid::Ptr grid_of(const LeafVolume &volume, const Value *values, typename Grid::ValueType background,
                           const char *name) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  static_assert(Leaf::SIZE == leaf_voxels, "leaves of 8 x 8 x 8 voxels");
  auto grid = Grid::create(background);
  grid->setName(name);
  grid->setTransform(transform_of(volume));
  for (std::size_t i = 0; i < volume.leaves; i++) {
    const std::int32_t *at = volume.leaf_origin + 3 * i;
    Leaf *leaf = grid->tree().touchLeaf(openvdb::Coord(at[0], at[1], at[2]));
    for (int voxel = 0; voxel < leaf_voxels; voxel++) {
      const auto value =
          static_cast<typename Grid::ValueType>(values[i * leaf_voxels + static_cast<std::size_t>(voxel)]);
      if (value == background)
        leaf->setValueOff(static_cast<openvdb::Index>(voxel), value);
      else
        leaf->setValueOn(static_cast<openvdb::Index>(voxel), value);
    }
  }
  return grid;
}

} // namespace

bool vdb_available() {
  return true;
}

void write_vdb(const LeafVolume &volume, const std::string &path) {
  openvdb::initialize();
  openvdb::GridPtrVec grids;
  if (volume.label) grids.push_back(grid_of<openvdb::Int32Grid>(volume, volume.label, 0, "label"));
  if (volume.distance) {
    grids.push_back(
        grid_of<openvdb::FloatGrid>(volume, volume.distance, static_cast<float>(volume.band), "distance"));
    grids.back()->setGridClass(openvdb::GRID_LEVEL_SET);
  }
  OutputFile output(path);
  try {
    openvdb::io::File file(output.temporary());
    file.write(grids);
    file.close();
  } catch (const openvdb::Exception &error) {
    fail(CONCEG_E_IO, "%s: expected to write an OpenVDB file, got: %s; check the folder and the free space",
         path.c_str(), error.what());
  }
  output.commit();
}

} // namespace conceg
