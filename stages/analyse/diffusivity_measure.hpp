// SPDX-License-Identifier: BSD-3-Clause
// D(t), K(t), how D(t) ends and lambda of the walkers of a document: /walkers -> tables, lines, CSV.
#pragma once

#include "conceg/params.h"
#include "parallel.hpp"
#include "tissue.hpp"
#include "transport.hpp"

namespace conceg::analyse {

// `limit`, `fine`: D* by the solver at voxels of 0 and as they are, null where it was not asked for.
void measure_diffusivity(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params, const Cells &cells,
                         const Transport *limit, const Transport *fine, Workers &workers);

} // namespace conceg::analyse
