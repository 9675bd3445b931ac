// SPDX-License-Identifier: BSD-3-Clause
// Connected pieces of a cell's surface: the piece around the soma stays, pinched-off pieces and cavities go
// and are reported.
#pragma once

#include "surface.hpp"

#include <vector>

namespace conceg::mesh {

struct Pieces {
  std::uint32_t detached = 0; // pieces cut off from the soma
  double detached_volume = 0; // um3
  std::uint32_t cavities = 0; // closed holes inside the kept piece, now filled
  double cavity_volume = 0;   // um3
  bool soma_found = true;     // false: no piece holds the soma centre, the largest one was kept
};

// Keeps the piece that holds `inside` (the soma centre, relative to the surface's origin), else the largest
// one.
Pieces keep_soma_piece(Surface &surface, const glm::dvec3 &inside, bool has_soma);

// V - E + F of a closed surface.
std::int64_t euler_characteristic(const SurfaceView &surface);

} // namespace conceg::mesh
