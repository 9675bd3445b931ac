// SPDX-License-Identifier: BSD-3-Clause
// The document's numbers and texts as JSON: tables of /statistics, small arrays, the list of what is there.
#pragma once

#include "json.hpp"

#include "conceg/doc.h"

#include <cstdint>

namespace conceg::reporting {

// Members "tables", "arrays", "contents", "paper" (its Table 1) and "recipe" of an object that is open in
// `json`. A table has at most `rows` rows; what is left out is stated beside it.
void put_facts(conceg_doc *doc, std::uint64_t rows, Json &json);

} // namespace conceg::reporting
