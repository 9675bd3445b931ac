// SPDX-License-Identifier: BSD-3-Clause
// The document's cells and meshes -> what SANDI should find.
#pragma once

#include "truth.hpp"

#include "conceg/doc.h"
#include "parallel.hpp"

#include <cstdint>

namespace conceg::fit {

struct Truth {
  bool known = false, box = false; // box: the periodic box is filled, so its fractions are known too
  double soma_share = 0.0;         // of the cells' volume
  double neurite = 0.0, soma = 0.0, extracellular = 0.0; // of the box
  std::uint64_t somas = 0;
  Radii sphere, mesh; // of the somas' spheres (/cells/radius); of spheres of the somas' mesh volumes
};

// From the closed surfaces of the finest level; not known without /meshes or their compartments, which is
// said in the log.
Truth read_truth(conceg_ctx *ctx, conceg_doc *doc, Workers &workers);

} // namespace conceg::fit
