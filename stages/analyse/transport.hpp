// SPDX-License-Identifier: BSD-3-Clause
// Transport tortuosity of a medium of voxels: lambda = sqrt(D_0 / D*), where D* is the long-time diffusivity
// in the open voxels of a box.
#pragma once

#include "open_voxels.hpp"

#include <array>

namespace conceg::analyse {

struct Transport {
  double open_fraction = 0;
  std::array<double, 3> ratio = {}; // D*_aa / D_0 along each axis
  std::array<int, 3> iterations = {};
  // Of the mean of the three; infinity where nothing goes through.
  double lambda() const;
};

// Solves the periodic cell problem  div (grad u_a + e_a) = 0, no flux into closed voxels,  by finite volumes
// and conjugate gradients (multigrid.hpp), to `tolerance` of the residual at the start; D*_aa / D_0 = <(grad
// u_a + e_a)_a> over the open voxels. Walls are staircases, so D* comes out low by about one voxel's size
// over the pore's; halve the voxels and extrapolate: D*(0) = 2 D*(h) - D*(2 h). A box that is not periodic is
// mirrored at its faces: it is what flows through it along a between faces at two concentrations, with no
// flux through the others. The result does not depend on the number of threads. `axes`: which of the three
// are solved (the others stay 0).
Transport transport_of(const OpenVoxels &voxels, const std::array<bool, 3> &axes, double tolerance,
                       Workers &workers, const Progress &progress);

// For voxels of twice the size: D*(0) = 2 D*(h) - D*(2 h).
Transport extrapolated(const Transport &coarse, const Transport &fine);

struct SolvedTransport {
  Transport limit, fine; // at voxels of 0 and as they are
};

} // namespace conceg::analyse
