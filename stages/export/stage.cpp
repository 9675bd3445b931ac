// SPDX-License-Identifier: BSD-3-Clause
// The export stage: named files for other programs.
#include "conceg/stage.h"
#include "formats.hpp"
#include "job.hpp"
#include "manifest.hpp"
#include "vdb.hpp"
#include "view.hpp"

#include <cstdio>
#include <cstring>

namespace {

using namespace conceg;
using namespace conceg::exporting;

const conceg_param parameters[] = {
    {"to", "", "format; all = vtk, ply and swc, whatever the document has data for", "all",
     "all" CONCEG_EXPORT_FORMATS(CONCEG_FORMAT_CHOICE), CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"dir", "", "folder to write into; made when absent", "export", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"cells", "", "all, one row such as 7, or one id such as id:12", "all", nullptr, CONCEG_PARAM_TEXT, 0, 0,
     0},
    {"wrapped", "",
     "vtk, ply, swc, stl, obj, gltf, h5v1: bring everything into the periodic box: skeletons are split at "
     "its sides, surfaces tiled",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"form", "",
     "vtk, ply, stl, obj, gltf: of surfaces; closed ones are tiled with wrapped, open and capped ones are "
     "cut at the "
     "periodic sides and left open or closed by lids in them; extracellular: one closed surface of the box "
     "without its cells",
     "closed", "closed|open|capped|extracellular", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"tiles", "",
     "vtk, ply, stl, obj, gltf: of surfaces; 2x2x1 repeats them along x and y, cut by form at the outer "
     "sides "
     "alone",
     "1x1x1", nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"level", "",
     "vtk, ply, stl, obj, gltf: of surfaces; 1 and more are coarser ones, for viewers, which mesh --levels "
     "makes "
     "and which may cross one another",
     "0", nullptr, CONCEG_PARAM_I64, 0, 0, 4},
    {"ascii", "", "ply: as text instead of binary", "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"columns", "", "caterpillar: of the table; the tenth is parent_component_id", "9", "9|10",
     CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"whole", "",
     "caterpillar, cactus: cells as they are stored, much of them outside of the voxel; otherwise all their "
     "periodic images that meet it, each connected piece as a cell or strand",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"walkers", "", "mcdc, disimpy, camino, rms: starting points, inside of cells and as many outside",
     "1000", nullptr, CONCEG_PARAM_I64, 0, 1, 1e8},
    {"diffusivity_um2_per_ms", "um^2/ms", "simulators: of the water, everywhere", "2", nullptr,
     CONCEG_PARAM_F64, 0, 1e-6, 1e3},
    {"b_values_ms_per_um2", "ms/um^2", "simulators: of the protocol", "0 1 2 3 5 10 15", nullptr,
     CONCEG_PARAM_TEXT, 0, 0, 0},
    {"directions", "", "simulators: for each b value above 0", "40", nullptr, CONCEG_PARAM_I64, 0, 1, 10000},
    {"pulse_ms", "ms", "simulators: length of a gradient pulse, delta", "5", nullptr, CONCEG_PARAM_F64, 0,
     1e-3, 1e4},
    {"separation_ms", "ms",
     "simulators: from the start of one pulse to the start of the next, Delta; at least the pulse", "20",
     nullptr, CONCEG_PARAM_F64, 0, 1e-3, 1e4},
    {"fraction_um", "um", "nifti: voxel of the fraction map", "2", nullptr, CONCEG_PARAM_F64, 0, 0.01, 1e6},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

// What a writer takes, and the stage that makes it.
struct Need {
  const char *path, *group, *stage;
};
const Need skeleton = {"/skeleton/position", "/skeleton", "the grow stage"},
           meshes = {"/meshes/face", "/meshes", "the mesh stage"},
           volumes = {"/volumes/leaf_origin", "/volumes", "the mesh stage"},
           network = {"/network/position", "/network", "the triangulate stage, and keep the network"};

const struct {
  const char *name;
  const Need *need; // NULL: whatever is there
  void (*write)(Job &);
} writers[] = {{"vtk", nullptr, export_vtk},
               {"ply", &meshes, export_ply},
               {"swc", &skeleton, export_swc},
               {"cactus", &skeleton, export_cactus},
               {"caterpillar", &skeleton, export_caterpillar},
               {"mcdc", &meshes, export_mcdc},
               {"disimpy", &meshes, export_disimpy},
               {"camino", &meshes, export_camino},
               {"rms", &volumes, export_rms},
               {"spindoctor", &meshes, export_spindoctor},
               {"dmipy-sim", &meshes, export_dmipy},
               {"mcmr", &meshes, export_mcmr},
               {"stl", &meshes, export_stl},
               {"obj", &meshes, export_obj},
               {"gltf", &meshes, export_gltf},
               {"vdb", &volumes, export_vdb},
               {"nifti", &volumes, export_nifti},
               {"h5v1", &skeleton, export_h5v1},
               {"network", &network, export_network}};
static_assert(std::size(writers) == std::size(export_formats), "a writer for each format of the list");

constexpr int kMostTiles = 1000; // along an axis

Tiles parse_tiles(const std::string &text) {
  Tiles tiles;
  char extra = 0;
  if (std::sscanf(text.c_str(), "%4dx%4dx%4d%c", &tiles.count[0], &tiles.count[1], &tiles.count[2], &extra) !=
      3)
    fail(CONCEG_E_PARAM, "tiles: expected three whole numbers such as 2x2x1, got %s", text.c_str());
  for (const int count : tiles.count)
    if (count < 1 || count > kMostTiles)
      fail(CONCEG_E_PARAM, "tiles: expected 1 to %d along each axis, got %s", kMostTiles, text.c_str());
  return tiles;
}

bool is_mesh_format(const std::string &name) {
  return name == "vtk" || name == "ply" || name == "stl" || name == "obj" || name == "gltf";
}

// What goes together.
void check_options(const Options &options) {
  if (options.level != 0 && options.form == Form::extracellular)
    fail(CONCEG_E_PARAM, "form=extracellular: expected level=0, as cells of coarser levels may cross, got %d",
         options.level);
  if (is_mesh_format(options.to)) return;
  if (!options.tiles.one() && options.to != "all")
    fail(CONCEG_E_PARAM, "tiles: expected one of vtk, ply, stl, obj, gltf, all for to, got %s",
         options.to.c_str());
  if (options.level != 0 && options.to != "all")
    fail(CONCEG_E_PARAM, "level: expected one of vtk, ply, stl, obj, gltf, all for to, got %s",
         options.to.c_str());
  if (options.form == Form::extracellular)
    fail(CONCEG_E_PARAM, "form=extracellular: expected one of vtk, ply, stl, obj, gltf for to, got %s",
         options.to.c_str());
}

void check_tiles(const conceg_box &box, const Tiles &tiles) {
  for (int axis = 0; axis < 3; axis++)
    if (tiles.count[axis] > 1 && !box.periodic[axis])
      fail(CONCEG_E_PARAM, "tiles: expected 1 along %c, where the box is open, got %d", "xyz"[axis],
           tiles.count[axis]);
}

Options read_options(const conceg_params *params) {
  Options options = {};
  options.to = conceg_params_text(params, "to"), options.dir = conceg_params_text(params, "dir"),
  options.cells = conceg_params_text(params, "cells");
  options.wrapped = conceg_params_bool(params, "wrapped") != 0,
  options.ascii = conceg_params_bool(params, "ascii") != 0;
  options.whole = conceg_params_bool(params, "whole") != 0;
  const std::string form = conceg_params_text(params, "form");
  options.form = form == "open"            ? Form::open
                 : form == "capped"        ? Form::capped
                 : form == "extracellular" ? Form::extracellular
                 : options.wrapped         ? Form::images
                                           : Form::closed;
  options.tiles = parse_tiles(conceg_params_text(params, "tiles"));
  options.level = static_cast<int>(conceg_params_i64(params, "level"));
  check_options(options);
  options.columns = std::strcmp(conceg_params_text(params, "columns"), "10") ? 9 : 10;
  options.walkers = static_cast<std::uint64_t>(conceg_params_i64(params, "walkers"));
  options.diffusivity = conceg_params_f64(params, "diffusivity_um2_per_ms"),
  options.fraction_um = conceg_params_f64(params, "fraction_um");
  options.protocol.b = parse_b_values(conceg_params_text(params, "b_values_ms_per_um2"));
  options.protocol.directions = static_cast<int>(conceg_params_i64(params, "directions"));
  options.protocol.pulse_ms = conceg_params_f64(params, "pulse_ms"),
  options.protocol.separation_ms = conceg_params_f64(params, "separation_ms");
  if (options.protocol.separation_ms < options.protocol.pulse_ms)
    fail(CONCEG_E_PARAM, "separation_ms: expected at least the pulse of %g ms, got %g",
         options.protocol.pulse_ms, options.protocol.separation_ms);
  return options;
}

const Format &format_named(const std::string &name) {
  for (const Format &format : export_formats)
    if (name == format.name) return format;
  fail(CONCEG_E_INTERNAL, "%s: a writer that is not in the list of formats", name.c_str());
}

// The groups that the wanted kinds of files need.
void check_groups(conceg_doc *doc, const Options &options) {
  check_tiles(read_box(doc), options.tiles);
  if (options.form == Form::extracellular && !has(doc, meshes.path))
    fail(CONCEG_E_MISSING, "/meshes: form=extracellular needs it, got none; run the mesh stage first");
  if (options.to == "vdb" && !vdb_available())
    fail(CONCEG_E_UNSUPPORTED, "vdb: this build has no OpenVDB; install libopenvdb-dev and build again");
  for (const auto &writer : writers)
    if (options.to == writer.name && writer.need && !has(doc, writer.need->path))
      fail(CONCEG_E_MISSING, "%s: %s files need it, got none; run %s first", writer.need->group, writer.name,
           writer.need->stage);
  if ((options.to == "all" || options.to == "vtk") && !has(doc, skeleton.path) && !has(doc, meshes.path))
    fail(CONCEG_E_MISSING, "/skeleton, /meshes: expected at least one of them to export, got none; run the "
                           "grow or the mesh stage first");
}

void export_files(conceg_ctx *ctx, conceg_doc *doc, const Options &options) {
  Job job(ctx, doc, options);
  const auto in_all = [](const std::string &name) { return name == "vtk" || name == "ply" || name == "swc"; };
  for (const auto &writer : writers) {
    const bool all =
        options.to == "all" && in_all(writer.name) && (!writer.need || has(doc, writer.need->path));
    if (!all && options.to != writer.name) continue;
    const std::size_t first = job.folder.written().size();
    writer.write(job);
    write_manifest(job, format_named(writer.name), first);
  }
  job.folder.write_index();
  for (const Written &row : job.folder.written())
    conceg_ctx_log(ctx, CONCEG_LOG_DEBUG, "export: %s/%s", options.dir.c_str(), row.file.c_str());
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "export: wrote %zu files for %zu cells into %s; index.csv lists them",
                 job.folder.written().size(), job.cells.size(), options.dir.c_str());
}

conceg_status check(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "export", [&] { check_groups(doc, read_options(params)); });
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "export", [&] {
    const Options options = read_options(params);
    check_groups(doc, options);
    export_files(ctx, doc, options);
  });
}

const char *const reads[] = {"/domain", nullptr};
const char *const nothing[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_export;
extern "C" const conceg_stage conceg_stage_export = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "export",
    "files",
    "1.3.0",
    "writes files for other programs: viewers, mesh tools, and simulators with all that they need beside the "
    "cells",
    "conceg export --to mcdc --dir cube_mcdc < cube.cgx",
    parameters,
    reads,
    nothing,
    nothing,
    CONCEG_STAGE_SINK,
    check,
    run};
