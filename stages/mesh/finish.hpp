// SPDX-License-Identifier: BSD-3-Clause
// From base meshes to the meshes that are written: simplify, check, and where the check finds something go
// back to the base mesh around that place, until the check finds nothing. A gap below half of the wanted one
// counts as a find: the base mesh keeps gap / 1.91.
#pragma once

#include "check.hpp"

namespace conceg::mesh {

struct FinishOptions {
  double tolerance = 0.02; // um; 0 = the base meshes as they are
  double gap = 0.04;       // um
  double h = 0.25;         // um, width of the first zone around a crossing that is left as it was
  int rounds = 5;          // the last one takes the whole base mesh of every cell that still crosses
};

struct Finished {
  std::vector<Surface> surfaces;
  CheckResult check;                // of the surfaces returned
  int rounds = 0;                   // repair rounds that were needed
  std::uint64_t repaired_pairs = 0; // crossings, folds and narrow gaps found on the way
};

Finished finish(const std::vector<Surface> &base, const conceg_box &box, const FinishOptions &options,
                Workers &workers, const Progress &progress);

} // namespace conceg::mesh
