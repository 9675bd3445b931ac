// SPDX-License-Identifier: BSD-3-Clause
// Labels that touch one another, such as those of electron microscopy of tissue whose extracellular space has
// collapsed, drawn back from their membranes until as much space is between them as asked for. All in
// sections across z, as voxels are often much longer along z.
#pragma once

#include "open_voxels.hpp"

namespace conceg::analyse {

// Labels of the voxels of a box, z fastest; 0 = none.
struct LabelGrid {
  std::array<std::size_t, 3> shape;
  std::vector<std::uint32_t> label;
  std::array<double, 3> spacing; // um
};

// Distance, um, of each voxel's centre to the nearest membrane in its section: to the nearest centre of
// another label less half a voxel. Labels go on beyond the faces of the box. Cut off at `deepest_um`.
std::vector<float> membrane_distances(const LabelGrid &grid, double deepest_um, Workers &workers);

struct Erosion {
  double depth = 0;                 // um, from each membrane
  double open_fraction = 0;         // of the sections
  double without_label = 0;         // share of the voxels that had no label before
  std::vector<OpenVoxels> sections; // across z, every `between` planes
  double labels_open_fraction = 0;  // of the labels that are left, at their own voxels
};

struct ErosionSettings {
  double open_fraction = 0.2; // asked for, of the sections
  std::size_t between = 8;
  std::size_t refine = 2; // voxels of the sections are at least so many times smaller, and up to 8 times
                          // where that is needed for clefts to be four voxels wide
};

// The depth at which the sections are as open as asked, within the steps of a histogram of 1/1000 voxel, and
// what they are then. Within a section the distance is linear between the centres of voxels, and negative
// where the label is another one. `grid` loses the labels of voxels whose centre is less deep. E_RANGE where
// more than that has no label, or where 32 voxels of depth are not enough.
Erosion erode(LabelGrid &grid, const ErosionSettings &settings, Workers &workers);

} // namespace conceg::analyse
