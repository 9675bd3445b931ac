// SPDX-License-Identifier: BSD-3-Clause
// OpenVDB for the stages: volumes as .vdb files, and the surface of a signed distance.
#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace conceg {

// Leaves of 8 x 8 x 8 voxels, x slowest, as /volumes and OpenVDB store them; borrowed arrays.
struct LeafVolume {
  glm::dvec3 origin, spacing; // um; centre of voxel (0, 0, 0)
  double band;                // um; the distance outside of all leaves, and of voxels farther than that
  std::size_t leaves;
  const std::int32_t *leaf_origin; // [leaves][3]
  const std::uint32_t *label;      // [leaves][512]; NULL = no such grid
  const float *distance;           // [leaves][512], um; NULL = no such grid
};

// Is OpenVDB in this build?
bool vdb_available();

// Writes the grids "label" (Int32, active inside cells) and "distance" (float, a level set, active within the
// band); whole or not at all. Uniform leaves become tiles. Throws E_IO or E_UNSUPPORTED.
void write_vdb(const LeafVolume &volume, const std::string &path);

struct VdbSurface {
  std::vector<glm::dvec3> vertex; // um
  std::vector<glm::dvec3> raw;    // where the mesher put them, each in a voxel of its own
  std::vector<glm::dvec3> normal; // outward, unit
  std::vector<glm::uvec3> face;   // outward
};

// The zero surface of `volume.distance` by OpenVDB's dual mesher, its vertices moved onto the zero set of a
// quadratic interpolation. The same for any number of threads. Throws E_UNSUPPORTED.
VdbSurface vdb_surface(const LeafVolume &volume, unsigned threads);

} // namespace conceg
