// SPDX-License-Identifier: BSD-3-Clause
// What each face belongs to: the compartment and the skeleton branch of the nearest primitive of its cell.
#pragma once

#include "field.hpp"
#include "surface.hpp"

namespace conceg::mesh {

struct FaceLabels {
  std::vector<std::uint8_t> compartment; // 1 soma, else the SWC code of the nearest segment
  std::vector<std::uint32_t> section;    // skeleton branch; kNoSection on the soma
};

FaceLabels label_faces(const Scene &scene, const Index &index, const Surface &surface, Workers &workers);

} // namespace conceg::mesh
