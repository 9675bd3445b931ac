// SPDX-License-Identifier: BSD-3-Clause
// characterise: SWC files and a table that groups them -> /dictionary.
#include "conceg/conceg.h"

#include "guard.hpp"
#include "read.hpp"
#include "write.hpp"

namespace conceg::characterise {
namespace {

constexpr const char *stage_name = "characterise";

std::string folder_of(const std::string &path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash);
}

Options read_options(const conceg_params *params, const std::string &table) {
  Options o;
  const std::string root = conceg_params_text(params, "root");
  o.table_folder = table.empty() ? "." : folder_of(table);
  o.root = root.empty() ? o.table_folder : root;
  o.cleaning.axons = conceg_params_bool(params, "axons") != 0;
  o.cleaning.axon_gap_um = conceg_params_f64(params, "axon_gap_um");
  o.cleaning.twig_length_um = conceg_params_f64(params, "twig_length_um");
  o.cleaning.twig_radius_um = conceg_params_f64(params, "twig_radius_um");
  o.cleaning.tree_length_um = conceg_params_f64(params, "tree_length_um");
  o.cleaning.lowest_radius_um = conceg_params_f64(params, "lowest_radius_um");
  o.astrocyte.branch_length_um = conceg_params_f64(params, "astrocyte_branch_um");
  o.astrocyte.territory_radius_um = conceg_params_f64(params, "astrocyte_territory_um");
  o.astrocyte_donors = static_cast<std::uint64_t>(conceg_params_i64(params, "astrocyte_donors"));
  o.metrics = conceg_params_text(params, "metrics");
  o.sources_path = conceg_params_text(params, "sources");
  if (!o.sources_path.empty()) o.sources = parse_sources(read_text(o.sources_path), o.sources_path);
  o.swc_flags = conceg_params_bool(params, "strict") ? CONCEG_SWC_STRICT : 0;
  return o;
}

std::vector<TableRow> read_rows(const conceg_params *params, const std::string &table) {
  if (!table.empty()) {
    if (conceg_params_argument(params, 0)) fail(CONCEG_E_USAGE, "give a table or SWC files, not both");
    return parse_table(read_text(table), table);
  }
  std::vector<TableRow> rows;
  for (std::uint32_t i = 0; const char *path = conceg_params_argument(params, i); i++) {
    TableRow row;
    row.file = path, row.entry = conceg_params_text(params, "entry"),
    row.cell_class = conceg_params_text(params, "class");
    row.frame = conceg_params_text(params, "frame"), row.whole_axon = true;
    rows.push_back(row);
  }
  if (rows.empty()) fail(CONCEG_E_USAGE, "no input; name SWC files, or a table with --table FILE");
  return rows;
}

void run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const std::string table = conceg_params_text(params, "table");
  const std::vector<TableRow> rows = read_rows(params, table);
  const Options options = read_options(params, table);
  Output out{{}, {}, {}, {}, {conceg_params_text(params, "pictures"), conceg_params_text(params, "beside")}};
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i;
    std::string note;
    for (; end < rows.size() && rows[end].entry == rows[i].entry; end++)
      if (rows[end].file.empty()) note += (note.empty() ? "" : " ") + rows[end].note;
    EntrySums sums;
    std::vector<FileExtent> extents;
    const std::string entry = rows[i].entry;
    open_entry(out.dictionary, entry, rows[i].cell_class, note), out.summary.open(entry);
    for (; i < end; i++) {
      must(conceg_ctx_progress(ctx, "reading cells", i, rows.size()));
      const TableRow &row = rows[i];
      if (row.file.empty()) continue;
      if (row.cell_class == "astrocyte" && row.file.size() > 4 &&
          row.file.substr(row.file.size() - 4) == ".csv")
        add_astrocytes(ctx, out, sums, row, options);
      else
        add_reconstruction(ctx, out, sums, extents, row, options);
    }
    check_units(entry, extents);
    close_entry(out.dictionary, sums);
  }
  write_dictionary(doc, out.dictionary);
  write_sources(doc, options.sources, out.dictionary.donor_source);
  if (options.metrics != "none")
    write_measures(doc, out.measures, out.summary.table(), conceg_params_text(params, "csv"));
  out.pictures.draw(ctx, out.dictionary);
  must(conceg_ctx_progress(ctx, "reading cells", rows.size(), rows.size()));
  log_result(ctx, options.cleaning, out);
}

const conceg_param parameters[] = {
    {"table", "", "comma-separated table of files and entries (stages/characterise/README.md)", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {"root", "", "folder that relative names in the table start from; then the table's folder is tried", "",
     nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"sources", "", "comma-separated table of where donors come from: source, repository, licence, terms", "",
     nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"entry", "", "without a table: name of the one entry", "cells", nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"class", "", "without a table: class of the cells", "pyramidal",
     "pyramidal|interneuron|astrocyte|microglia|axon|other", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"frame", "", "without a table: where the pia is in the files", "unknown",
     "apical|+x|-x|+y|-y|+z|-z|unknown", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"axons", "",
     "keep the largest axon tree of each cell whose table row says axon full (without a table: of each cell)",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"axon_gap_um", "um",
     "loose pieces of a kept axon are joined to it over gaps up to this; 0 keeps the largest tree alone",
     "20", nullptr, CONCEG_PARAM_F64, 0, 0, 1000},
    {"twig_length_um", "um",
     "neurons: terminal branches shorter than this and thinner than twig_radius_um are spines; 0 keeps all",
     "3", nullptr, CONCEG_PARAM_F64, 0, 0, 100},
    {"twig_radius_um", "um", "mean radius below which a short terminal branch is a spine", "0.3", nullptr,
     CONCEG_PARAM_F64, 0, 0, 100},
    {"tree_length_um", "um", "trees with less cable are left out", "3", nullptr, CONCEG_PARAM_F64, 0, 1e-3,
     1e4},
    {"lowest_radius_um", "um", "smaller radii are raised to this", "0.05", nullptr, CONCEG_PARAM_F64, 0, 1e-3,
     10},
    {"metrics", "",
     "tables of metrics per section and cell (/statistics): of the cells as cleaned or as read, or none",
     "cleaned", "cleaned|read|none", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"csv", "", "folder for the same tables as comma-separated files; made when absent", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {"pictures", "", "folder for a figure of every entry as an SVG file; made when absent", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {"beside", "", "document with cells that grew from these entries: drawn beside the donors, with pictures",
     "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"strict", "", "read SWC strictly: warnings marked S are errors", "false", nullptr, CONCEG_PARAM_BOOL, 0,
     0, 0},
    {"astrocyte_donors", "1", "cells to make of each table of astrocyte barcodes", "16", nullptr,
     CONCEG_PARAM_I64, 0, 1, 1000},
    {"astrocyte_branch_um", "um",
     "wanted mean branch length; so many bars are kept, by persistence, as come nearest", "13", nullptr,
     CONCEG_PARAM_F64, 0, 1, 1000},
    {"astrocyte_territory_um", "um", "radius of the territory; longer bars are cut", "27.5", nullptr,
     CONCEG_PARAM_F64, 0, 1, 1000},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0},
};
const char *const nothing[] = {nullptr};
const char *const writes[] = {"/dictionary", "/statistics", nullptr};

conceg_status run_stage(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, stage_name, [&] { run(ctx, doc, params); });
}

} // namespace
} // namespace conceg::characterise

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_characterise;
extern "C" const conceg_stage conceg_stage_characterise = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "characterise",
    "barcode",
    "1.0.0",
    "real reconstructions (SWC) to a dictionary of barcodes, tip directions, angles and radii",
    "conceg characterise --table data/mouse-visual-cortex.csv --root FOLDER -o dictionary.cgx",
    conceg::characterise::parameters,
    conceg::characterise::nothing,
    conceg::characterise::writes,
    conceg::characterise::nothing,
    CONCEG_STAGE_SOURCE | CONCEG_STAGE_ARGUMENTS,
    nullptr,
    conceg::characterise::run_stage,
};
