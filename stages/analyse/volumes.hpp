// SPDX-License-Identifier: BSD-3-Clause
// Volume and area of closed surfaces by the divergence theorem.
#pragma once

#include "parallel.hpp"
#include "tissue.hpp"

namespace conceg::analyse {

struct Size {
  double volume = 0; // um3 that lies in the box
  double area = 0;   // um2 that lies in the box
};

// Per surface. A cell's images fill what its surface leaves out, so on periodic axes the whole of it counts;
// on open axes only what lies between the faces. E_FORMAT naming the surface when it is inside out (negative
// volume).
std::vector<Size> surface_sizes(const Meshes &meshes, const conceg_box &box, Workers &workers);

} // namespace conceg::analyse
