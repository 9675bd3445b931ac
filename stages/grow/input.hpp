// SPDX-License-Identifier: BSD-3-Clause
// Reading growth's input from a document, with every value checked before it is used as a size or an index.
#pragma once

#include "conceg/doc.h"
#include "state.hpp"

namespace conceg::grow {

// Views stay valid while the document keeps the arrays.
Input read_input(conceg_doc *doc, std::uint64_t seed);
// Adds what an earlier growth left to the input, when the document has it.
void read_earlier(conceg_doc *doc, Input &input);
// An error where too few edges are short enough to be candidates; looks at 100 000 nodes at most.
void check_spacing(const Input &input, double max_edge_um);

} // namespace conceg::grow
