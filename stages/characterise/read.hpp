// SPDX-License-Identifier: BSD-3-Clause
// One row of the table: its file is read, cleaned, measured and put into what is collected.
#pragma once

#include "astrocyte.hpp"
#include "dictionary.hpp"
#include "group.hpp"
#include "measures.hpp"
#include "pictures.hpp"
#include "preprocess.hpp"
#include "summary.hpp"
#include "table.hpp"

#include "conceg/ctx.h"

namespace conceg::characterise {

struct Options {
  Cleaning cleaning;
  AstrocyteRules astrocyte;
  std::string root, table_folder, metrics, sources_path;
  std::vector<Source> sources;
  std::uint64_t astrocyte_donors = 0;
  std::uint32_t swc_flags = 0;
};
// What is collected over all files.
struct Output {
  Dictionary dictionary;
  Measures measures;
  Summary summary;
  Cleaned cleaned;
  Pictures pictures;
};

std::string read_text(const std::string &path);

// A reconstruction (SWC), as a donor of the open entry.
void add_reconstruction(conceg_ctx *ctx, Output &out, EntrySums &sums, std::vector<FileExtent> &extents,
                        const TableRow &row, const Options &options);
// Donors that are made of a table of barcodes.
void add_astrocytes(conceg_ctx *ctx, Output &out, EntrySums &sums, const TableRow &row,
                    const Options &options);

} // namespace conceg::characterise
