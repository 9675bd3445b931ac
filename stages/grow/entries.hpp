// SPDX-License-Identifier: BSD-3-Clause
// What the dictionary's entries ask of the types: the straightness of their branches, the calibre of their
// bars.
#pragma once

#include "state.hpp"

struct conceg_doc;

namespace conceg::grow {

// Fills the types' part of the input, with the straightness and the bars' calibre where they are wanted. A
// document without a dictionary, or whose dictionary lacks these tables, asks nothing.
void read_entries(conceg_doc *doc, bool straightness, bool calibre, Input &input);

} // namespace conceg::grow
