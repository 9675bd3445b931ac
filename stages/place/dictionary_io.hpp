// SPDX-License-Identifier: BSD-3-Clause
// The dictionary between a document and plain arrays, and the one that is embedded in the program.
#pragma once

#include "dictionary.hpp"

#include "conceg/doc.h"

#include <string>

namespace conceg::place {

// "default" = the embedded dictionary, else a CGX file; checked against every rule of the format.
Dictionary load_dictionary(conceg_ctx *ctx, const std::string &name);
void write_dictionary(conceg_doc *doc, const Dictionary &dictionary);

} // namespace conceg::place
