// SPDX-License-Identifier: BSD-3-Clause
// One cell as SWC-plus through the library's writer.
#pragma once

#include "source.hpp"

namespace conceg::exporting {

// `wrapped` says that the tree was split at the box, which makes floating pieces; the header says so too.
// `footer` holds the comment lines by which the document can be restored; with them the order of the
// document's rows is noted.
void write_swc(conceg_ctx *ctx, const std::string &path, const Cell &cell, const Tree &tree,
               const conceg_box &box, std::uint64_t seed, bool wrapped,
               const std::vector<std::string> &footer);

} // namespace conceg::exporting
