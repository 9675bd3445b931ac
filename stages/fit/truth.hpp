// SPDX-License-Identifier: BSD-3-Clause
// What the geometry says about the figures that SANDI estimates. Plain arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace conceg::fit {

// Closed surfaces with a compartment code per face (1 soma, 19 nucleus, others as in spec/cgx.md).
struct Surfaces {
  std::vector<std::uint32_t> cell;
  std::vector<std::uint64_t> vertex_offset, face_offset; // surfaces + 1
  const double *vertex = nullptr;                        // x y z, um
  const std::uint32_t *face = nullptr;       // three each, counted from the surface's first vertex
  const std::uint8_t *compartment = nullptr; // one each
};

struct SomaVolume {
  double soma = 0.0, total = 0.0; // um^3
};

// Volumes of surface `row`. The soma is what the faces labelled soma enclose with flat caps where processes
// leave it: fans from each border edge to the mean of its loop's vertices. Throws Error(E_FORMAT) for faces
// that name vertices beyond the surface's.
SomaVolume soma_volume(const Surfaces &surfaces, std::size_t row);

struct Radii {
  double mean = 0.0, volume_weighted = 0.0, effective = 0.0; // um; <R>, <R^4>/<R^3>, (<R^7>/<R^3>)^(1/4)
};
// Of radii above 0; zeros when there is none.
Radii radii_of(const std::vector<double> &radius);

} // namespace conceg::fit
