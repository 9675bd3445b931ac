// SPDX-License-Identifier: BSD-3-Clause
#include "faces.hpp"

namespace conceg::mesh {

FaceLabel label_face(const Scene &scene, const Index &index, const SurfaceView &surface, std::size_t face) {
  const glm::uvec3 &f = surface.face[face];
  const glm::dvec3 centre = (surface.at(f.x) + surface.at(f.y) + surface.at(f.z)) / 3.0;
  const std::int64_t nearest = nearest_cone(scene, index, surface.cell, scene.grid.voxel_of(centre));
  if (nearest < 0) return {};
  const Cone &cone = scene.cone[static_cast<std::size_t>(nearest)];
  return {cone.kind, scene.section[cone.section].branch};
}

} // namespace conceg::mesh
