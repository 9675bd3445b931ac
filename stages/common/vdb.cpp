// SPDX-License-Identifier: BSD-3-Clause
// The only file that knows OpenVDB.
#include "vdb.hpp"

#include "output.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

namespace conceg {
namespace {

constexpr int leaf_voxels = 512;

template <class Grid>
typename Grid::Ptr empty_grid(const LeafVolume &volume, double background, const char *name) {
  auto grid = Grid::create(static_cast<typename Grid::ValueType>(background));
  auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  transform->preScale(openvdb::Vec3d(volume.spacing.x, volume.spacing.y, volume.spacing.z));
  transform->postTranslate(openvdb::Vec3d(volume.origin.x, volume.origin.y, volume.origin.z));
  grid->setTransform(transform);
  grid->setName(name);
  grid->setCreator("ConCeG");
  grid->insertMeta("length_unit", openvdb::StringMetadata("um"));
  return grid;
}

// Copies leaves, whose voxels are in the order of OpenVDB's.
template <class Grid, class Value, class Active>
void add_leaves(Grid &grid, const LeafVolume &volume, const Value *values, Active active) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  static_assert(Leaf::SIZE == leaf_voxels, "leaves of 8 x 8 x 8 voxels");
  for (std::size_t i = 0; i < volume.leaves; i++) {
    const std::int32_t *at = volume.leaf_origin + 3 * i;
    Leaf *leaf = grid.tree().touchLeaf(openvdb::Coord(at[0], at[1], at[2]));
    for (openvdb::Index voxel = 0; voxel < leaf_voxels; voxel++) {
      const auto value = static_cast<typename Grid::ValueType>(values[i * leaf_voxels + voxel]);
      if (active(value))
        leaf->setValueOn(voxel, value);
      else
        leaf->setValueOff(voxel, value);
    }
  }
}

openvdb::Int32Grid::Ptr label_grid(const LeafVolume &volume) {
  const auto grid = empty_grid<openvdb::Int32Grid>(volume, 0, "label");
  add_leaves(*grid, volume, volume.label, [](std::int32_t label) { return label != 0; });
  openvdb::tools::prune(grid->tree());
  return grid;
}

openvdb::FloatGrid::Ptr distance_grid(const LeafVolume &volume) {
  const auto grid = empty_grid<openvdb::FloatGrid>(volume, volume.band, "distance");
  const float band = grid->background();
  add_leaves(*grid, volume, volume.distance, [band](float d) { return std::fabs(d) < band; });
  openvdb::tools::prune(grid->tree());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

// Places in the index space of a grid, looked at with a quadratic interpolation.
class Sampler {
public:
  explicit Sampler(const openvdb::FloatGrid &grid, const glm::dvec3 &spacing)
      : accessor_(grid.getConstAccessor()), sampler_(accessor_, grid.transform()), spacing_(spacing) {}

  double value(const glm::dvec3 &at) const {
    return static_cast<double>(sampler_.isSample(openvdb::Vec3R(at.x, at.y, at.z)));
  }
  glm::dvec3 gradient(const glm::dvec3 &at) const { // in space
    glm::dvec3 out;
    for (int axis = 0; axis < 3; axis++) {
      glm::dvec3 half(0.0);
      half[axis] = 0.5;
      out[axis] = (value(at + half) - value(at - half)) / spacing_[axis];
    }
    return out;
  }

private:
  openvdb::FloatGrid::ConstAccessor accessor_;
  openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::QuadraticSampler> sampler_;
  const glm::dvec3 spacing_;
};

// Two Newton steps onto the zero set; together they stay within half a voxel.
void settle(const Sampler &sampler, const LeafVolume &volume, glm::dvec3 &vertex, glm::dvec3 &normal) {
  const glm::dvec3 start = (vertex - volume.origin) / volume.spacing;
  glm::dvec3 at = start;
  for (int turn = 0; turn < 2; turn++) {
    const glm::dvec3 gradient = sampler.gradient(at);
    const double steepness = glm::length(gradient);
    if (!(steepness > 0.1)) break; // on a crest or in a valley the direction means nothing
    normal = gradient / steepness;
    at -= sampler.value(at) / steepness * normal / volume.spacing;
    at = glm::clamp(at, start - 0.5, start + 0.5);
  }
  vertex = volume.origin + at * volume.spacing;
}

void add_quad(const std::vector<glm::dvec3> &vertex, const openvdb::Vec4I &q, std::vector<glm::uvec3> &face) {
  const bool first = glm::distance(vertex[q[0]], vertex[q[2]]) <= glm::distance(vertex[q[1]], vertex[q[3]]);
  if (first)
    face.emplace_back(q[0], q[1], q[2]), face.emplace_back(q[0], q[2], q[3]);
  else
    face.emplace_back(q[0], q[1], q[3]), face.emplace_back(q[1], q[2], q[3]);
}

VdbSurface surface_of(const LeafVolume &volume) {
  const openvdb::FloatGrid::Ptr grid = distance_grid(volume);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, triangles, quads, 0.0, 0.0);
  VdbSurface out;
  for (const openvdb::Vec3s &p : points)
    out.vertex.emplace_back(p.x(), p.y(), p.z());
  out.raw = out.vertex;
  out.normal.assign(points.size(), glm::dvec3(0, 0, 1));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size()), [&](const auto &range) {
    const Sampler sampler(*grid, volume.spacing);
    for (std::size_t i = range.begin(); i < range.end(); i++)
      settle(sampler, volume, out.vertex[i], out.normal[i]);
  });
  for (const openvdb::Vec4I &q : quads)
    add_quad(out.vertex, q, out.face);
  for (const openvdb::Vec3I &t : triangles)
    out.face.emplace_back(t[0], t[1], t[2]);
  // OpenVDB winds its faces so that they look inward.
  for (glm::uvec3 &f : out.face)
    std::swap(f.y, f.z);
  return out;
}

} // namespace

bool vdb_available() {
  return true;
}

void write_vdb(const LeafVolume &volume, const std::string &path) {
  openvdb::initialize();
  openvdb::GridPtrVec grids;
  if (volume.label) grids.push_back(label_grid(volume));
  if (volume.distance) grids.push_back(distance_grid(volume));
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

VdbSurface vdb_surface(const LeafVolume &volume, unsigned threads) {
  openvdb::initialize();
  tbb::task_arena arena(std::min(static_cast<int>(threads), tbb::info::default_concurrency()));
  VdbSurface out;
  arena.execute([&] { out = surface_of(volume); });
  return out;
}

} // namespace conceg
