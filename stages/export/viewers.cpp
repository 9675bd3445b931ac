// SPDX-License-Identifier: BSD-3-Clause
// --to vtk, ply and swc: which files, of which cells.
#include "job.hpp"
#include "swc.hpp"
#include "swc_document.hpp"
#include "vtk.hpp"

namespace conceg::exporting {
namespace {

void export_skeletons(Job &job) {
  std::vector<Tree> trees;
  std::vector<SkeletonPiece> pieces;
  Written row;
  trees.reserve(job.cells.size());
  for (const Cell &cell : job.cells) {
    trees.push_back(job.tree_of(cell));
    row.points += trees.back().size() + (cell.soma_radius > 0.0);
    pieces.push_back(
        {&trees.back(), cell.soma, cell.soma_radius, static_cast<std::uint32_t>(cell.row), cell.type});
  }
  row.file = "vtk/skeletons.vtp", row.what = "skeletons";
  write_skeletons_vtp(job.folder.at(row.file), pieces);
  job.folder.add(std::move(row));
}

void export_surfaces(Job &job) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < job.cells.size(); i++) {
    const Cell &cell = job.cells[i];
    report(job.progress, "export: surfaces", i, job.cells.size());
    const CellSurface mesh = job.surface_of(cell);
    if (mesh.surface.face.empty()) continue;
    const std::string name = name_of(cell);
    blocks.push_back({"surfaces/" + name + ".vtp", name});
    Written row = job.about(cell, "vtk/surfaces/" + name + ".vtp", "surface");
    row.points = mesh.surface.vertex.size(), row.faces = mesh.surface.face.size();
    write_surface_vtp(job.folder.at(row.file), {&mesh.surface, mesh.compartment, mesh.component, mesh.section,
                                                static_cast<std::uint32_t>(cell.row), cell.type});
    job.folder.add(std::move(row));
  }
  if (blocks.empty()) return;
  Written row;
  row.file = "vtk/surfaces.vtm", row.what = "surfaces";
  write_blocks_vtm(job.folder.at(row.file), blocks);
  job.folder.add(std::move(row));
}

void export_volume(Job &job) {
  if (job.source.volume_bytes() > static_cast<double>(conceg_ctx_memory(job.ctx))) {
    conceg_ctx_log(
        job.ctx, CONCEG_LOG_WARNING,
        "export: vtk/volume.vti is left out: it needs %.0f MB of memory; raise --memory to write it",
        job.source.volume_bytes() * 1e-6);
    return;
  }
  const Volume volume = job.source.volume();
  Written row;
  row.file = "vtk/volume.vti", row.what = "volume";
  row.points = std::max(volume.label.size(), volume.distance.size());
  write_volume_vti(job.folder.at(row.file), volume);
  job.folder.add(std::move(row));
}

// What the SWC-plus files cannot carry is said.
void warn_of_left_out(Job &job) {
  std::string groups;
  for (const std::string &group : swcdoc::left_out(job.doc))
    groups += (groups.empty() ? "" : ", ") + group;
  if (!groups.empty())
    conceg_ctx_log(job.ctx, CONCEG_LOG_WARNING,
                   "export: SWC-plus files carry the document without %s; keep the .cgx file for these",
                   groups.c_str());
}

} // namespace

void export_vtk(Job &job) {
  if (job.options.form == Form::extracellular) return write_extracellular(job, "vtk");
  if (job.source.has_skeleton()) export_skeletons(job);
  if (job.source.has_meshes()) export_surfaces(job);
  if (job.source.has_volumes() && job.options.cells == "all") export_volume(job);
}

// For the file's header; nothing when cells are as they stand.
static const char *form_text(Form form) {
  switch (form) {
  case Form::images:
    return "all triangle images that meet the periodic box";
  case Form::open:
    return "all images cut at the periodic sides, open there";
  case Form::capped:
    return "all images cut at the periodic sides, closed by lids there";
  case Form::closed:
  case Form::extracellular:
    break;
  }
  return nullptr;
}

void export_ply(Job &job) {
  if (job.options.form == Form::extracellular) return write_extracellular(job, "ply");
  const char *const images = form_text(job.options.form);
  std::vector<Surface> surfaces;
  for (std::size_t i = 0; i < job.cells.size(); i++) {
    report(job.progress, "export: PLY", i, job.cells.size());
    CellSurface mesh = job.surface_of(job.cells[i]);
    if (mesh.surface.face.empty()) continue;
    write_ply_file(job, "ply/" + name_of(job.cells[i]) + ".ply", {&mesh.surface}, &job.cells[i],
                   job.options.ascii, "lengths in um", images);
    surfaces.push_back(std::move(mesh.surface));
  }
  if (surfaces.size() < 2) return;
  std::vector<const Surface *> all;
  for (const Surface &surface : surfaces)
    all.push_back(&surface);
  write_ply_file(job, "ply/all_cells.ply", all, nullptr, job.options.ascii, "lengths in um", images);
}

// The whole document goes along, unless only a part of the cells, or pieces of them, are written.
void export_swc(Job &job) {
  const bool whole = job.options.cells == "all" && !job.options.wrapped;
  swcdoc::Slices slices;
  char digest[65] = "";
  if (whole) {
    slices = swcdoc::slices_of(job.doc);
    must(conceg_doc_digest(job.doc, "/", digest));
    warn_of_left_out(job);
  }
  std::size_t empty = 0;
  for (std::size_t i = 0; i < job.cells.size(); i++) {
    const Cell &cell = job.cells[i];
    report(job.progress, "export: SWC", i, job.cells.size());
    const Tree tree = job.tree_of(cell);
    // A passing axon that found no free start: a file without samples is none.
    if (tree.size() == 0 && !(cell.soma_radius > 0.0)) {
      empty++;
      continue;
    }
    Written row = job.about(cell, "swc/" + name_of(cell) + ".swc", "skeleton");
    std::vector<std::string> footer;
    if (whole) footer = swcdoc::cell_lines(job.doc, slices, cell.row, digest);
    if (whole && i == empty) { // this is the first file
      const std::vector<std::string> more = swcdoc::document_lines(job.doc, slices, digest);
      footer.insert(footer.end(), more.begin(), more.end());
    }
    write_swc(job.ctx, job.folder.at(row.file), cell, tree, job.source.box(), job.source.seed(),
              job.options.wrapped, footer);
    row.points = tree.size();
    job.folder.add(std::move(row));
  }
  if (empty > 0)
    conceg_ctx_log(job.ctx, CONCEG_LOG_WARNING,
                   "export: %zu cells without soma and skeleton have no SWC file", empty);
}

} // namespace conceg::exporting
