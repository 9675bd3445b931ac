// SPDX-License-Identifier: BSD-3-Clause
// Sizes of the pores of a medium of voxels, by all five definitions in use. They differ by factors: compare a
// figure with one of the same definition, the same number of dimensions and the same open fraction only.
#pragma once

#include "open_voxels.hpp"

#include <vector>

namespace conceg::analyse {

struct Distribution {
  std::uint64_t count = 0;
  double mean = 0, sd = 0, median = 0, p95 = 0; // um
};

// All 0 of no values.
Distribution distribution(std::vector<double> values);

struct PoreSpace {
  Distribution centres; // radius at the maxima of the distance, those that stand out by half a voxel or more
                        // (the paper)
  Distribution voxels;  // radius at every open voxel
  Distribution thickness; // per open voxel, radius of the largest ball in the pores that holds it
  Distribution gaps;      // twice the radius on the medial surface
  Distribution chords;    // lengths of the straight runs along the axes
};

// Radius of each voxel: distance to the nearest centre of a closed voxel less half a voxel, over all images
// on periodic axes; 0 in closed voxels. All voxels must be of about one size; one plane (a side of 1) is a
// section in 2-D. In a medium without closed voxels all are 0.
std::vector<float> pore_radii(const OpenVoxels &voxels, Workers &workers);

// Median of the radii of all open voxels, which is a quarter of the width of a flat cleft; 0 without any,
// half of the longest side when all are open.
double median_radius(const OpenVoxels &voxels, Workers &workers);

// Over all of the given media, such as the sections of one. Where an axis is not periodic nothing is known
// beyond its faces: maxima that lie closer to one than their radius are left out, as are all voxels closer
// than twice the largest radius of the medium, and chords that reach a face. The result does not depend on
// the number of threads.
PoreSpace pore_space(const std::vector<OpenVoxels> &media, Workers &workers);

} // namespace conceg::analyse
