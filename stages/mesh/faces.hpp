// SPDX-License-Identifier: BSD-3-Clause
// What each face belongs to: the compartment and the skeleton branch of the nearest primitive of its cell.
#pragma once

#include "field.hpp"
#include "surface.hpp"

namespace conceg::mesh {

struct FaceLabel {
  std::uint8_t compartment = kSomaKind; // 1 soma, else the SWC code of the nearest segment
  std::uint32_t section = kNoSection;   // skeleton branch; kNoSection on the soma
};

FaceLabel label_face(const Scene &scene, const Index &index, const SurfaceView &surface, std::size_t face);

} // namespace conceg::mesh
