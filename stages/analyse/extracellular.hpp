// SPDX-License-Identifier: BSD-3-Clause
// The analyses of voxels that the stage runs: composition of the labels, and pores, paths and transport of
// the extracellular space, in the whole box, in sections of eroded labels, or in blocks cut out of the
// meshes.
#pragma once

#include "experiment_tables.hpp"
#include "transport.hpp"

#include "conceg/stage.h"

#include <functional>
#include <optional>

namespace conceg::analyse {

struct ExtracellularInput {
  bool has_labels, has_meshes;
  double median_distance; // um, of /volumes/distance outside of all cells; 0 = unknown
  const conceg_box &box;
  std::function<LabelVolume()> volume; // read, and checked, when they are needed
  std::function<Meshes()> meshes;
};

// Does what the parameters ask for, and writes and logs the tables. What is too coarse or too small is logged
// as void. Returns D* of the whole box, where it was asked for and found.
std::optional<SolvedTransport> measure_extracellular(conceg_ctx *ctx, conceg_doc *doc,
                                                     const conceg_params *params,
                                                     const ExtracellularInput &input, Workers &workers);

} // namespace conceg::analyse
