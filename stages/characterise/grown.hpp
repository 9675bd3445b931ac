// SPDX-License-Identifier: BSD-3-Clause
// Grown cells of a document, to stand beside the donors that they grew from.
#pragma once

#include "metrics.hpp"

#include "conceg/doc.h"

#include <string>
#include <vector>

namespace conceg::characterise {

struct GrownCell {
  std::uint64_t id = 0;
  std::string entry, donor; // by name; donor "" = not known
  bool turned_back = false; // into the frame of its donor; else as it stands in the box
  metrics::Samples samples; // the soma's centre at 0
};

// The cells of the file that have a skeleton. E_MISSING when it has no /types, /cells, /skeleton or
// /dictionary, E_FORMAT when one of them breaks a rule.
std::vector<GrownCell> read_grown(conceg_ctx *ctx, const std::string &path);
// The same of an open document, which `path` names in errors.
std::vector<GrownCell> grown_cells(conceg_doc *doc, const std::string &path);

} // namespace conceg::characterise
