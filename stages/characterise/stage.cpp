// SPDX-License-Identifier: BSD-3-Clause
// characterise: SWC files and a table that groups them -> /dictionary.
#include "conceg/conceg.h"

#include "astrocyte.hpp"
#include "dictionary.hpp"
#include "guard.hpp"
#include "measures.hpp"
#include "output.hpp"
#include "pictures.hpp"
#include "preprocess.hpp"
#include "table.hpp"
#include "view.hpp"

#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

namespace conceg::characterise {
namespace {

constexpr const char *stage_name = "characterise";

struct Options {
  Cleaning cleaning;
  AstrocyteRules astrocyte;
  std::string root, table_folder, metrics;
  std::uint64_t astrocyte_donors = 0;
  std::uint32_t swc_flags = 0;
};

struct FreeSwc {
  void operator()(conceg_swc *swc) const { conceg_swc_free(swc); }
};
using Swc = std::unique_ptr<conceg_swc, FreeSwc>;

std::string read_text(const std::string &path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  if (!in || !(out << in.rdbuf())) fail(CONCEG_E_IO, "%s: cannot be read; check the path", path.c_str());
  return out.str();
}

std::string folder_of(const std::string &path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash);
}
std::string stem_of(const std::string &path) {
  const std::size_t slash = path.rfind('/'), from = slash == std::string::npos ? 0 : slash + 1,
                    dot = path.rfind('.');
  return path.substr(from, dot == std::string::npos || dot < from ? std::string::npos : dot - from);
}
// A file of the table: an absolute name, else below the root, else beside the table.
std::string find_file(const Options &options, const std::string &path) {
  if (path[0] == '/') return path;
  const std::string below = options.root == "." ? path : options.root + "/" + path,
                    beside = options.table_folder + "/" + path;
  return !std::ifstream(below) && std::ifstream(beside) ? beside : below;
}

void log_problems(conceg_ctx *ctx, const std::string &path, const conceg_swc *swc) {
  std::uint32_t severity, line;
  const char *code, *text;
  for (std::uint32_t i = 0; conceg_swc_problem(swc, i, &severity, &line, &code, &text); i++)
    conceg_ctx_log(ctx, CONCEG_LOG_DEBUG, "%s:%u: %s: %s", path.c_str(), line, code, text);
}

Samples copy_samples(const conceg_swc *swc) {
  Samples s;
  const std::uint64_t count = conceg_swc_count(swc);
  const double *position = conceg_swc_position(swc), *radius = conceg_swc_radius(swc);
  for (std::uint64_t i = 0; i < count; i++) {
    s.position.emplace_back(position[3 * i], position[3 * i + 1], position[3 * i + 2]);
    s.radius.push_back(radius[i]);
    s.kind.push_back(conceg_swc_kind(swc)[i]);
    s.parent.push_back(conceg_swc_parent(swc)[i]);
    s.on_soma.push_back(conceg_swc_on_soma(swc)[i] != 0);
  }
  return s;
}

// The direction of the pia in the file, by the table's word for it.
Donor make_donor(const TableRow &row, const Cell &cell, const std::string &path) {
  Donor donor;
  donor.id = row.donor_id.empty() ? stem_of(row.file) : row.donor_id;
  donor.fold = static_cast<std::uint8_t>(row.fold);
  donor.frame_kind = "unknown";
  if (row.frame == "unknown") return donor;
  glm::dvec3 axis(0.0);
  if (row.frame == "apical") {
    axis = apical_axis(cell);
    if (axis == glm::dvec3(0.0))
      fail(CONCEG_E_FORMAT, "%s: frame apical: expected samples of type 4, got none; give an axis or unknown",
           path.c_str());
    donor.frame_kind = "apical";
  } else {
    axis[row.frame[1] - 'x'] = row.frame[0] == '-' ? -1.0 : 1.0;
    donor.frame_kind = "axis";
  }
  donor.frame = rotation_to_z(axis);
  return donor;
}

void add_reconstruction(conceg_ctx *ctx, Dictionary &dictionary, EntrySums &sums, Measures &measures,
                        Pictures &pictures, const TableRow &row, const Options &options) {
  const std::string path = find_file(options, row.file);
  conceg_swc *raw = nullptr;
  const conceg_status status = conceg_swc_read(ctx, path.c_str(), options.swc_flags, &raw);
  const Swc swc(raw);
  must(status);
  log_problems(ctx, path, swc.get());

  Cell cell;
  double center[3];
  conceg_swc_soma(swc.get(), center, &cell.soma_radius);
  cell.soma = {center[0], center[1], center[2]};
  Cleaning rules = options.cleaning;
  rules.axons = rules.axons && row.whole_axon;
  rules.glia = row.cell_class == "microglia" || row.cell_class == "astrocyte";
  if (rules.glia) rules.twig_length_um = 0.0; // glia have no spines
  if (row.soma_radius_um > 0.0) cell.soma_radius = row.soma_radius_um, rules.clip_at_soma = true;
  if (!(cell.soma_radius > 0.0))
    fail(CONCEG_E_FORMAT, "%s: expected a soma, got none; give soma_radius_um in the table or another file",
         path.c_str());

  Cleaned left_out;
  const Samples samples = copy_samples(swc.get());
  cell.trees = clean_trees(samples, cell.soma, cell.soma_radius, rules, left_out);
  if (cell.trees.empty()) fail(CONCEG_E_FORMAT, "%s: expected trees on the soma, got none", path.c_str());
  const Donor donor = make_donor(row, cell, path);
  const CellFigures f = add_cell(dictionary, sums, donor, cell);
  pictures.keep(dictionary, cell);
  if (options.metrics != "none") {
    const metrics::Samples measured =
        options.metrics == "read" ? whole_cell(samples, cell.soma, cell.soma_radius) : whole_cell(cell);
    measures.add(row.entry, donor.id, metrics::measure(measured, sholl_step_um));
  }
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "%s %s: %zu trees, %zu bars, %zu branches; order %.2f, branch %.1f um, angle %.1f degree, "
                 "straightness %.3f, radius %.3f um, "
                 "cable %.0f um; left out: %zu twigs, %zu floating trees, %zu axon pieces, %zu short trees; "
                 "%zu radii raised",
                 row.entry.c_str(), donor.id.c_str(), f.trees, f.bars, f.sections, f.order, f.length,
                 f.angle * 57.29577951308232, f.straight, f.radius, f.cable, left_out.twigs,
                 left_out.floating, left_out.axon_pieces, left_out.short_trees, left_out.raised_radii);
}

void add_astrocytes(conceg_ctx *ctx, Dictionary &dictionary, EntrySums &sums, const TableRow &row,
                    const Options &options) {
  const std::string path = find_file(options, row.file);
  const AstrocyteStatistics statistics = parse_astrocyte(read_text(path), path);
  for (std::uint64_t k = 0; k < options.astrocyte_donors; k++) {
    const Astrocyte cell = make_astrocyte(statistics, options.astrocyte, conceg_ctx_seed(ctx), k);
    Donor donor;
    char number[24];
    std::snprintf(number, sizeof number, "%02u", static_cast<unsigned>(k));
    donor.id = (row.donor_id.empty() ? stem_of(row.file) : row.donor_id) + "_" + number;
    donor.fold = static_cast<std::uint8_t>(k % 5), donor.frame_kind = "unknown";
    add_bar_trees(dictionary, donor, cell.soma_radius, cell.trees);
    for (const BarTree &tree : cell.trees)
      for (const BarRow &bar : tree.bars)
        if (bar.parent >= 0) sums.angles.push_back(bar.angle);
  }
  sums.branches = 1, sums.straight = options.astrocyte.straightness;
  sums.straight_squared =
      sums.straight * sums.straight + options.astrocyte.straightness_sd * options.astrocyte.straightness_sd;
}

Options read_options(const conceg_params *params, const std::string &table) {
  Options o;
  const std::string root = conceg_params_text(params, "root");
  o.table_folder = table.empty() ? "." : folder_of(table);
  o.root = root.empty() ? o.table_folder : root;
  o.cleaning.axons = conceg_params_bool(params, "axons") != 0;
  o.cleaning.twig_length_um = conceg_params_f64(params, "twig_length_um");
  o.cleaning.twig_radius_um = conceg_params_f64(params, "twig_radius_um");
  o.cleaning.tree_length_um = conceg_params_f64(params, "tree_length_um");
  o.cleaning.lowest_radius_um = conceg_params_f64(params, "lowest_radius_um");
  o.astrocyte.branch_length_um = conceg_params_f64(params, "astrocyte_branch_um");
  o.astrocyte.territory_radius_um = conceg_params_f64(params, "astrocyte_territory_um");
  o.astrocyte_donors = static_cast<std::uint64_t>(conceg_params_i64(params, "astrocyte_donors"));
  o.metrics = conceg_params_text(params, "metrics");
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

void write_dictionary(conceg_doc *doc, const Dictionary &d) {
  put_texts(doc, "/dictionary/entry_name", d.entry_name);
  put_texts(doc, "/dictionary/entry_class", d.entry_class);
  put_texts(doc, "/dictionary/entry_note", d.entry_note);
  put(doc, "/dictionary/entry_donor_offset", d.entry_donor_offset);
  put(doc, "/dictionary/entry_angle_offset", d.entry_angle_offset);
  put(doc, "/dictionary/entry_straightness", d.entry_straightness);
  put(doc, "/dictionary/entry_straightness_sd", d.entry_straightness_sd);
  put(doc, "/dictionary/angle", d.angle);
  put_texts(doc, "/dictionary/donor_id", d.donor_id);
  put(doc, "/dictionary/donor_fold", d.donor_fold);
  put(doc, "/dictionary/donor_frame", d.donor_frame.empty() ? nullptr : d.donor_frame[0].data(),
      d.donor_frame.size(), 4);
  put_texts(doc, "/dictionary/donor_frame_kind", d.donor_frame_kind);
  put(doc, "/dictionary/donor_soma_radius", d.donor_soma_radius);
  put(doc, "/dictionary/donor_tree_offset", d.donor_tree_offset);
  put(doc, "/dictionary/tree_neurite", d.tree_neurite);
  put3(doc, "/dictionary/tree_trunk_direction", d.tree_trunk_direction);
  put(doc, "/dictionary/tree_bar_offset", d.tree_bar_offset);
  put(doc, "/dictionary/bar_birth", d.bar_birth);
  put(doc, "/dictionary/bar_death", d.bar_death);
  put(doc, "/dictionary/bar_parent", d.bar_parent);
  put(doc, "/dictionary/bar_radius", d.bar_radius);
  put(doc, "/dictionary/bar_taper", d.bar_taper);
  put(doc, "/dictionary/bar_cv", d.bar_cv);
  put(doc, "/dictionary/bar_correlation_length", d.bar_correlation_length);
  put(doc, "/dictionary/bar_angle", d.bar_angle);
  put3(doc, "/dictionary/bar_tip_direction", d.bar_tip_direction);
  put(doc, "/dictionary/bar_tip_distance", d.bar_tip_distance);
}

// Tables of the document and, where a folder is named, files.
void write_measures(conceg_doc *doc, const Measures &measures, const std::string &folder) {
  if (!measures.cells().rows()) return;
  if (!folder.empty()) make_folder(folder);
  for (const Table *table : {&measures.sections(), &measures.cells(), &measures.sholl()}) {
    write_table(doc, *table);
    if (folder.empty()) continue;
    OutputFile file(folder + "/" + table->name + ".csv");
    file.write(table->csv());
    file.commit();
  }
}

void run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const std::string table = conceg_params_text(params, "table");
  const std::vector<TableRow> rows = read_rows(params, table);
  const Options options = read_options(params, table);
  Dictionary dictionary;
  Measures measures;
  Pictures pictures(conceg_params_text(params, "pictures"), conceg_params_text(params, "beside"));
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i;
    std::string note;
    for (; end < rows.size() && rows[end].entry == rows[i].entry; end++)
      if (rows[end].file.empty()) note += (note.empty() ? "" : " ") + rows[end].note;
    EntrySums sums;
    open_entry(dictionary, rows[i].entry, rows[i].cell_class, note);
    for (; i < end; i++) {
      must(conceg_ctx_progress(ctx, "reading cells", i, rows.size()));
      const TableRow &row = rows[i];
      if (row.file.empty()) continue;
      if (row.cell_class == "astrocyte" && row.file.size() > 4 &&
          row.file.substr(row.file.size() - 4) == ".csv")
        add_astrocytes(ctx, dictionary, sums, row, options);
      else
        add_reconstruction(ctx, dictionary, sums, measures, pictures, row, options);
    }
    close_entry(dictionary, sums);
  }
  write_dictionary(doc, dictionary);
  write_measures(doc, measures, conceg_params_text(params, "csv"));
  pictures.draw(ctx, dictionary);
  must(conceg_ctx_progress(ctx, "reading cells", rows.size(), rows.size()));
}

const conceg_param parameters[] = {
    {"table", "", "comma-separated table of files and entries (stages/characterise/README.md)", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {"root", "", "folder that relative names in the table start from; then the table's folder is tried", "",
     nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"entry", "", "without a table: name of the one entry", "cells", nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"class", "", "without a table: class of the cells", "pyramidal",
     "pyramidal|interneuron|astrocyte|microglia|axon|other", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"frame", "", "without a table: where the pia is in the files", "unknown",
     "apical|+x|-x|+y|-y|+z|-z|unknown", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"axons", "",
     "keep the largest axon tree of each cell whose table row says axon full (without a table: of each cell)",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
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
