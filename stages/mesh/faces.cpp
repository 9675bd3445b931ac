// SPDX-License-Identifier: BSD-3-Clause
#include "faces.hpp"

namespace conceg::mesh {

FaceLabels label_faces(const Scene &scene, const Index &index, const Surface &surface, Workers &workers) {
  FaceLabels labels;
  labels.compartment.resize(surface.face.size(), kSomaKind);
  labels.section.resize(surface.face.size(), kNoSection);
  workers.loop(surface.face.size(), 4096, [&](std::size_t f, unsigned) {
    const glm::uvec3 &face = surface.face[f];
    const glm::dvec3 centre = (surface.at(face.x) + surface.at(face.y) + surface.at(face.z)) / 3.0;
    const std::int64_t nearest = nearest_cone(scene, index, surface.cell, scene.grid.voxel_of(centre));
    if (nearest < 0) return;
    const Cone &cone = scene.cone[static_cast<std::size_t>(nearest)];
    labels.compartment[f] = cone.kind;
    labels.section[f] = scene.section[cone.section].branch;
  });
  return labels;
}

} // namespace conceg::mesh
