// SPDX-License-Identifier: BSD-3-Clause
// The only file that knows OpenVDB.
#include "output.hpp"
#include "volume.hpp"

#include <openvdb/openvdb.h>

#include <string>

namespace conceg::mesh {
namespace {

openvdb::math::Transform::Ptr transform_of(const Volume &volume) {
  auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  transform->preScale(openvdb::Vec3d(volume.spacing.x, volume.spacing.y, volume.spacing.z));
  transform->postTranslate(openvdb::Vec3d(volume.origin.x, volume.origin.y, volume.origin.z));
  return transform;
}

// Copies leaves whose voxels are stored in the same order as OpenVDB's.
template <class Grid, class Value>
typename Grid::Ptr grid_of(const Volume &volume, const std::vector<Value> &values,
                           typename Grid::ValueType background, const char *name) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  static_assert(Leaf::SIZE == kLeafVoxels, "leaves of 8 x 8 x 8 voxels");
  auto grid = Grid::create(background);
  grid->setName(name);
  grid->setTransform(transform_of(volume));
  for (std::size_t i = 0; i < volume.leaf_origin.size(); i++) {
    const glm::ivec3 &at = volume.leaf_origin[i];
    Leaf *leaf = grid->tree().touchLeaf(openvdb::Coord(at.x, at.y, at.z));
    for (int voxel = 0; voxel < kLeafVoxels; voxel++) {
      const auto value =
          static_cast<typename Grid::ValueType>(values[i * kLeafVoxels + static_cast<std::size_t>(voxel)]);
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

void write_vdb(const Volume &volume, const char *path) {
  openvdb::initialize();
  const auto label = grid_of<openvdb::Int32Grid>(volume, volume.label, 0, "label");
  const auto distance =
      grid_of<openvdb::FloatGrid>(volume, volume.distance, static_cast<float>(volume.band), "distance");
  distance->setGridClass(openvdb::GRID_LEVEL_SET);
  OutputFile output(path);
  try {
    openvdb::io::File file(output.temporary());
    file.write(openvdb::GridPtrVec{label, distance});
    file.close();
  } catch (const openvdb::Exception &error) {
    fail(CONCEG_E_IO, "%s: expected to write an OpenVDB file, got: %s; check the folder and the free space",
         path, error.what());
  }
  output.commit();
}

} // namespace conceg::mesh
