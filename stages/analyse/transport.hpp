// SPDX-License-Identifier: BSD-3-Clause
// Transport tortuosity of a medium of voxels: lambda = sqrt(D_0 / D*), where D* is the long-time diffusivity
// in the open voxels of a periodic box.
#pragma once

#include "parallel.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::analyse {

// Voxels of a periodic box, z fastest; 1 = open.
struct OpenVoxels {
  std::array<std::size_t, 3> shape;
  std::vector<std::uint8_t> open;
  std::array<double, 3> spacing; // um
};

struct Transport {
  double open_fraction = 0;
  std::array<double, 3> ratio = {}; // D*_aa / D_0 along each axis
  std::array<int, 3> iterations = {};
  // Of the mean of the three; infinity where nothing goes through.
  double lambda() const;
};

// Solves the periodic cell problem  div (grad u_a + e_a) = 0, no flux into closed voxels,  by finite volumes
// and conjugate gradients, to `tolerance` of the residual at the start; D*_aa / D_0 = <(grad u_a + e_a)_a>
// over the open voxels. Walls are staircases, so D* comes out low by about one voxel's size over the pore's;
// halve the voxels and extrapolate. The result does not depend on the number of threads. `axes`: which of the
// three are solved (the others stay 0).
Transport transport_of(const OpenVoxels &voxels, const std::array<bool, 3> &axes, double tolerance,
                       Workers &workers, const Progress &progress);

// The same at voxels of twice the size, each of which is open where most of its eight are (the lowest one
// decides between halves); for extrapolation D*(0) = 2 D*(h) - D*(2 h). All sides must be even.
OpenVoxels coarser(const OpenVoxels &voxels);
Transport extrapolated(const Transport &coarse, const Transport &fine);

} // namespace conceg::analyse
