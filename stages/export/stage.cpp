// SPDX-License-Identifier: BSD-3-Clause
// The export stage: named files for other programs.
#include "conceg/conceg.h"
#include "folder.hpp"
#include "guard.hpp"
#include "parallel.hpp"
#include "ply.hpp"
#include "source.hpp"
#include "swc.hpp"
#include "swc_document.hpp"
#include "vtk.hpp"

#include <string>
#include <vector>

namespace {

using namespace conceg;
using namespace conceg::exporting;

const conceg_param parameters[] = {
    {"to", "", "kinds of files; all = what the document has data for", "all", "all|vtk|ply|swc",
     CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"dir", "", "folder to write into; made when absent", "export", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"cells", "", "all, one row such as 7, or one id such as id:12", "all", nullptr, CONCEG_PARAM_TEXT, 0, 0,
     0},
    {"wrapped", "",
     "bring everything into the periodic box: skeletons are split at its sides, surfaces tiled", "false",
     nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"ascii", "", "PLY as text, which MC/DC needs, instead of binary", "false", nullptr, CONCEG_PARAM_BOOL, 0,
     0, 0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

struct Options {
  std::string to, dir, cells;
  bool wrapped, ascii;
  bool wants(const char *kind) const { return to == "all" || to == kind; }
};

Options read_options(const conceg_params *params) {
  return {conceg_params_text(params, "to"), conceg_params_text(params, "dir"),
          conceg_params_text(params, "cells"), conceg_params_bool(params, "wrapped") != 0,
          conceg_params_bool(params, "ascii") != 0};
}

// The groups that the wanted kinds of files need.
void check_groups(conceg_doc *doc, const Options &options) {
  const bool skeleton = has(doc, "/skeleton/position"), meshes = has(doc, "/meshes/face");
  if (options.to == "swc" && !skeleton)
    fail(CONCEG_E_MISSING, "/skeleton: SWC files need skeletons, got none; run the grow stage first");
  if (options.to == "ply" && !meshes)
    fail(CONCEG_E_MISSING, "/meshes: PLY files need surfaces, got none; run the mesh stage first");
  if (!skeleton && !meshes)
    fail(CONCEG_E_MISSING, "/skeleton, /meshes: expected at least one of them to export, got none; run the "
                           "grow or the mesh stage first");
}

class Exporter {
public:
  Exporter(conceg_ctx *ctx, conceg_doc *doc, const Options &options)
      : ctx_(ctx), doc_(doc), options_(options), source_(doc), cells_(source_.select(options.cells)),
        folder_(options.dir), progress_(progress_of(ctx)) {}

  void run() {
    if (source_.has_skeleton() && options_.wants("swc")) export_swc();
    if (source_.has_skeleton() && options_.wants("vtk")) export_skeletons();
    if (source_.has_meshes()) export_surfaces();
    if (source_.has_volumes() && options_.wants("vtk") && options_.cells == "all") export_volume();
    folder_.write_index();
    for (const Written &row : folder_.written())
      conceg_ctx_log(ctx_, CONCEG_LOG_DEBUG, "export: %s/%s", options_.dir.c_str(), row.file.c_str());
    conceg_ctx_log(ctx_, CONCEG_LOG_INFO,
                   "export: wrote %zu files for %zu cells into %s; index.csv lists them",
                   folder_.written().size(), cells_.size(), options_.dir.c_str());
  }

private:
  Written about(const Cell &cell, std::string file, const char *what) const {
    Written row;
    row.file = std::move(file), row.what = what, row.cell = static_cast<std::int64_t>(cell.row),
    row.id = cell.id;
    row.type = cell.type_name, row.layer = cell.layer;
    return row;
  }
  Tree tree_of(const Cell &cell) const {
    Tree tree = source_.tree(cell.row);
    return options_.wrapped ? split_at_box(tree, source_.box()) : tree;
  }

  // The whole document goes along, unless only a part of the cells, or pieces of them, are written.
  void export_swc() {
    const bool whole = options_.cells == "all" && !options_.wrapped;
    swcdoc::Slices slices;
    char digest[65] = "";
    if (whole) {
      slices = swcdoc::slices_of(doc_);
      must(conceg_doc_digest(doc_, "/", digest));
      std::string groups;
      for (const std::string &group : swcdoc::left_out(doc_))
        groups += (groups.empty() ? "" : ", ") + group;
      if (!groups.empty())
        conceg_ctx_log(ctx_, CONCEG_LOG_WARNING,
                       "export: SWC-plus files carry the document without %s; keep the .cgx file for these",
                       groups.c_str());
    }
    std::size_t empty = 0;
    for (std::size_t i = 0; i < cells_.size(); i++) {
      report(progress_, "export: SWC", i, cells_.size());
      const Tree tree = tree_of(cells_[i]);
      // A passing axon that found no free start: a file without samples is none.
      if (tree.size() == 0 && !(cells_[i].soma_radius > 0.0)) {
        empty++;
        continue;
      }
      Written row =
          about(cells_[i], "swc/" + cell_file_name(cells_[i].row, cells_[i].type_name) + ".swc", "skeleton");
      std::vector<std::string> footer;
      if (whole) footer = swcdoc::cell_lines(doc_, slices, cells_[i].row, digest);
      if (whole && i == empty) { // this is the first file
        const std::vector<std::string> more = swcdoc::document_lines(doc_, slices, digest);
        footer.insert(footer.end(), more.begin(), more.end());
      }
      write_swc(ctx_, folder_.at(row.file), cells_[i], tree, source_.box(), source_.seed(), options_.wrapped,
                footer);
      row.points = tree.size();
      folder_.add(std::move(row));
    }
    if (empty > 0)
      conceg_ctx_log(ctx_, CONCEG_LOG_WARNING, "export: %zu cells without soma and skeleton have no SWC file",
                     empty);
  }

  void export_skeletons() {
    std::vector<Tree> trees;
    std::vector<SkeletonPiece> pieces;
    Written row;
    trees.reserve(cells_.size());
    for (const Cell &cell : cells_) {
      trees.push_back(tree_of(cell));
      row.points += trees.back().size() + (cell.soma_radius > 0.0);
      pieces.push_back(
          {&trees.back(), cell.soma, cell.soma_radius, static_cast<std::uint32_t>(cell.row), cell.type});
    }
    row.file = "vtk/skeletons.vtp", row.what = "skeletons";
    write_skeletons_vtp(folder_.at(row.file), pieces);
    folder_.add(std::move(row));
  }

  void export_surfaces() {
    std::vector<Block> blocks;
    std::vector<Surface> surfaces; // of all cells, for the joint PLY
    for (std::size_t i = 0; i < cells_.size(); i++) {
      report(progress_, "export: surfaces", i, cells_.size());
      CellSurface mesh = source_.surface(cells_[i].row, options_.wrapped);
      if (mesh.surface.face.empty()) continue;
      const std::string name = cell_file_name(cells_[i].row, cells_[i].type_name);
      if (options_.wants("vtk")) {
        blocks.push_back({"surfaces/" + name + ".vtp", name});
        Written row = about(cells_[i], "vtk/surfaces/" + name + ".vtp", "surface");
        row.points = mesh.surface.vertex.size(), row.faces = mesh.surface.face.size();
        write_surface_vtp(folder_.at(row.file),
                          {&mesh.surface, mesh.compartment, mesh.component, mesh.section,
                           static_cast<std::uint32_t>(cells_[i].row), cells_[i].type});
        folder_.add(std::move(row));
      }
      if (options_.wants("ply")) {
        export_ply("ply/" + name + ".ply", {&mesh.surface}, &cells_[i]);
        surfaces.push_back(std::move(mesh.surface));
      }
    }
    if (!blocks.empty()) {
      Written row;
      row.file = "vtk/surfaces.vtm", row.what = "surfaces";
      write_blocks_vtm(folder_.at(row.file), blocks);
      folder_.add(std::move(row));
    }
    if (surfaces.size() > 1) {
      std::vector<const Surface *> all;
      for (const Surface &surface : surfaces)
        all.push_back(&surface);
      export_ply("ply/all_cells.ply", all, nullptr);
    }
  }

  void export_ply(const std::string &file, const std::vector<const Surface *> &surfaces, const Cell *cell) {
    std::vector<std::string> comments = {"ConCeG " CONCEG_VERSION_TEXT
                                         ", lengths in um, triangles wound outward"};
    if (cell)
      comments.push_back("cell " + std::to_string(cell->row) + ", id " + std::to_string(cell->id) +
                         ", type " + cell->type_name);
    if (options_.wrapped) comments.push_back("all triangle images that meet the periodic box");
    OutputFile output(folder_.at(file));
    write_ply(output, surfaces, options_.ascii, comments);
    output.commit();
    Written row;
    if (cell) row = about(*cell, file, "surface");
    row.file = file, row.what = cell ? "surface" : "surfaces";
    for (const Surface *surface : surfaces)
      row.points += surface->vertex.size(), row.faces += surface->face.size();
    folder_.add(std::move(row));
  }

  void export_volume() {
    if (source_.volume_bytes() > static_cast<double>(conceg_ctx_memory(ctx_))) {
      conceg_ctx_log(
          ctx_, CONCEG_LOG_WARNING,
          "export: vtk/volume.vti is left out: it needs %.0f MB of memory; raise --memory to write it",
          source_.volume_bytes() * 1e-6);
      return;
    }
    const Volume volume = source_.volume();
    Written row;
    row.file = "vtk/volume.vti", row.what = "volume";
    row.points = std::max(volume.label.size(), volume.distance.size());
    write_volume_vti(folder_.at(row.file), volume);
    folder_.add(std::move(row));
  }

  conceg_ctx *ctx_;
  conceg_doc *doc_;
  const Options &options_;
  Source source_;
  std::vector<Cell> cells_;
  OutputFolder folder_;
  Progress progress_;
};

conceg_status check(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "export", [&] { check_groups(doc, read_options(params)); });
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "export", [&] {
    const Options options = read_options(params);
    check_groups(doc, options);
    Exporter(ctx, doc, options).run();
  });
}

const char *const reads[] = {"/domain", "/types", "/cells", nullptr};
const char *const nothing[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_export;
extern "C" const conceg_stage conceg_stage_export = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "export",
    "files",
    "1.0.0",
    "writes VTK, PLY and SWC-plus files of all cells or of one",
    "conceg export --dir cube_files < cube.cgx",
    parameters,
    reads,
    nothing,
    nothing,
    CONCEG_STAGE_SINK,
    check,
    run};
