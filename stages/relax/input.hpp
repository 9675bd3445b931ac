// SPDX-License-Identifier: BSD-3-Clause
// Reading what relax needs from a document.
#pragma once

#include "chains.hpp"

#include "conceg/doc.h"

#include <string>

namespace conceg::relax {

// Arrays of /skeleton and /cells; make_bodies checks them.
Skeletons read_skeletons(conceg_doc *doc);

// The class of each cell, and their names.
struct Classes {
  std::vector<std::string> name;
  std::vector<std::uint32_t> of_cell;
};

Classes read_classes(conceg_doc *doc, std::size_t cells);

} // namespace conceg::relax
