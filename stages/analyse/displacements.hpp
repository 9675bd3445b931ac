// SPDX-License-Identifier: BSD-3-Clause
// What `conceg simulate` kept of its walkers' ways: /walkers and the parameters in /provenance.
#pragma once

#include "tissue.hpp"
#include "view.hpp"

#include <cstdint>
#include <vector>

namespace conceg::analyse {

struct Displacements {
  std::vector<double> time;              // ms, ascending
  std::vector<const glm::dvec3 *> moved; // of each time: [walkers], um, unwrapped; borrowed from the document
  std::vector<std::int64_t> cell;        // where each walker began: row of /cells, -1 = between cells
  std::vector<std::uint8_t> compartment; // code; empty when the document has none
  double free_extra = 0.0;               // um^2/ms, the simulation's diffusivity between cells; 0 = not known
  bool permeable = false;                // walkers may pass membranes
};

// E_MISSING without displacements, E_FORMAT where arrays do not match.
Displacements read_displacements(conceg_ctx *ctx, conceg_doc *doc, const Cells &cells);

} // namespace conceg::analyse
