// SPDX-License-Identifier: BSD-3-Clause
// Volumes as OpenVDB files, for the stages that write them.
#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <string>

namespace conceg {

// Leaves of 8 x 8 x 8 voxels, x slowest, as /volumes and OpenVDB store them; borrowed arrays.
struct LeafVolume {
  glm::dvec3 origin, spacing; // um; centre of voxel (0, 0, 0)
  double band;                // um; the distance outside of all leaves
  std::size_t leaves;
  const std::int32_t *leaf_origin; // [leaves][3]
  const std::uint32_t *label;      // [leaves][512]; NULL = no such grid
  const float *distance;           // [leaves][512], um; NULL = no such grid
};

// Is OpenVDB in this build?
bool vdb_available();
// Writes the grids "label" (Int32) and "distance" (float, level set); whole or not at all. Throws E_IO or
// E_UNSUPPORTED.
void write_vdb(const LeafVolume &volume, const std::string &path);

} // namespace conceg
