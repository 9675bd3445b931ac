// SPDX-License-Identifier: BSD-3-Clause
// `--structure` of the stage: documents in, tables, lines and files out.
#pragma once

#include "parallel.hpp"
#include "tissue.hpp"

#include "conceg/stage.h"

#include <string>

namespace conceg::analyse {

struct StructureOptions {
  std::string real, pool, folder; // paths; `pool` separated by commas
  bool asked() const { return !real.empty() || !pool.empty() || !folder.empty(); }
};

// Takes away the tables of an earlier run.
void drop_structure(conceg_doc *doc);
void measure_structure(conceg_ctx *ctx, conceg_doc *doc, const StructureOptions &options, const Cells &cells,
                       const Skeletons &skeletons, Workers &workers);

} // namespace conceg::analyse
