// SPDX-License-Identifier: BSD-3-Clause
// What was collected, as arrays of the document, as tables and as lines for people.
#pragma once

#include "read.hpp"

#include "conceg/doc.h"

namespace conceg::characterise {

void write_dictionary(conceg_doc *doc, const Dictionary &d);
void write_sources(conceg_doc *doc, const std::vector<Source> &sources,
                   const std::vector<std::uint32_t> &of_donor);
// Tables of the document and, where a folder is named, files.
void write_measures(conceg_doc *doc, const Measures &measures, const Table &summary,
                    const std::string &folder);
// The entries beside the paper's, and what was left out.
void log_result(conceg_ctx *ctx, const Cleaning &rules, const Output &out);

} // namespace conceg::characterise
