// SPDX-License-Identifier: BSD-3-Clause
// The SWC files of a document: which ones, read, with their blocks.
#pragma once

#include "scene.hpp"
#include "swc_document.hpp"

#include <memory>
#include <string>
#include <vector>

namespace conceg::importing {

struct FreeSwc {
  void operator()(conceg_swc *swc) const { conceg_swc_free(swc); }
};

struct SwcFile {
  std::string path;
  std::unique_ptr<conceg_swc, FreeSwc> swc;
  swcdoc::Blocks blocks;
  bool stale = false; // a column that was edited contradicts its exact value
};

// Groups of the format that a folder of SWC-plus files carries.
inline constexpr const char *known_groups[] = {"recipe",     "domain",   "provenance", "types",
                                               "dictionary", "cells",    "bars",       "skeleton",
                                               "spheres",    "protocol", "signals",    "statistics"};

// Reads them; warnings go to the log, at most ten a file. E_FORMAT names the file and the line.
std::vector<SwcFile> read_files(conceg_ctx *ctx, const std::vector<std::string> &paths, std::uint32_t flags);

// The document that the files carry, as it was. Cells that were edited keep the edit, and what depends on
// them is left out. All files must have blocks of one document. Returns whether nothing was edited.
bool restore_document(conceg_ctx *ctx, conceg_doc *doc, std::vector<SwcFile> &files);

// The cells of plain SWC files.
Scene read_foreign_swc(const std::vector<SwcFile> &files, const Request &request);

} // namespace conceg::importing
