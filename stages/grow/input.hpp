// SPDX-License-Identifier: BSD-3-Clause
// Reading growth's input from a document, with every value checked before it is used as a size or an index.
#pragma once

#include "conceg/doc.h"
#include "state.hpp"

namespace conceg::grow {

// Views stay valid while the document keeps the arrays.
Input read_input(conceg_doc *doc, std::uint64_t seed);

} // namespace conceg::grow
