// SPDX-License-Identifier: BSD-3-Clause
// /protocol and /signals -> measurements, by compartment and timing.
#pragma once

#include "shells.hpp"
#include "signal.hpp"

#include "conceg/doc.h"

#include <string>
#include <vector>

namespace conceg::fit {

struct Signal {
  std::string name; // compartment, with the timing where there are several
  std::string compartment;
  Timing timing;
  Measurements rows;
};

// `wanted`: names of compartments separated by commas; empty = intra and all, as far as they are there.
// Measurements that are no pair of pulses are left out with a warning. E_MISSING names the compartments that
// there are.
std::vector<Signal> read_signals(conceg_ctx *ctx, conceg_doc *doc, const std::string &wanted);

} // namespace conceg::fit
