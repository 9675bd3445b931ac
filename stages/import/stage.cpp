// SPDX-License-Identifier: BSD-3-Clause
// import: files of other programs, or of our own export, -> a document.
#include "conceg/stage.h"
#include "formats.hpp"
#include "labels.hpp"
#include "scene.hpp"
#include "signal_document.hpp"

namespace {

using namespace conceg;
using namespace conceg::importing;

const conceg_param parameters[] = {
    {"class", "",
     "swc, ply: class of the cells; auto = by the file: swc: pyramidal with a type-4 sample, astrocyte with "
     "a type-7 one, else other",
     "auto", "auto|pyramidal|interneuron|astrocyte|microglia|axon|other", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"margin_um", "um", "formats without a box: space between the cells and the sides of the box", "5",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1e6},
    {"box_um", "um",
     "side of the box: swc, caterpillar [0, L]^3, ply [-L/2, L/2]^3; 0 = growth_info, or put around", "0",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1e6},
    {"info", "", "caterpillar: its growth_info file; empty = looked for beside the table", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {"roots", "", "swc: a file is one cell, or each tree that is not on the soma is a cell of its own", "one",
     "one|cells", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"radius_min_um", "um", "swc: smaller radii are raised to this; 0 = a radius of 0 is an error", "0",
     nullptr, CONCEG_PARAM_F64, 0, 0, 100},
    {"floating", "", "swc: trees that are not joined to the soma", "keep", "keep|drop|attach",
     CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"strict", "", "swc: read strictly: warnings marked S are errors", "false", nullptr, CONCEG_PARAM_BOOL, 0,
     0, 0},
    {"bval", "", "signals: FSL file with b in s/mm^2, one for each number of the file of signals", "",
     nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"bvec", "", "signals: FSL file with the directions, three lines", "", nullptr, CONCEG_PARAM_FILE, 0, 0,
     0},
    {"compartment", "", "signals: what they are of, where the file does not say: all, intra, ...", "all",
     nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"pulse_duration_ms", "ms", "signals: delta, where the file does not say", "0", nullptr, CONCEG_PARAM_F64,
     0, 0, 1e5},
    {"pulse_separation_ms", "ms", "signals: Delta, start to start, where the file does not say", "0", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1e5},
    {"voxel_um", "um", "labels: size of a voxel along x, y, z, such as 0.016,0.016,0.04; or one for all", "",
     nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"array", "", "labels: which array of a .npz; empty = the only one, or `labels`", "", nullptr,
     CONCEG_PARAM_TEXT, 0, 0, 0},
    {"axes", "", "labels: order of the file's axes", "xyz", "xyz|zyx", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"resample_um", "um", "labels: voxels of this size instead, by the nearest label; 0 = as they are", "0",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1e3},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

Scene read_wmg(const Request &request) {
  Scene scene;
  const std::string &path = only_file(request, "a JSON file");
  parse_wmg(read_bytes(request.ctx, path), path, scene);
  return scene;
}

// Formats that are read into a scene; swc, network, signal and labels make their document themselves.
const struct {
  const char *name;
  Scene (*read)(const Request &);
} readers[] = {{"cactus", read_cactus}, {"ply", read_ply_folder},  {"caterpillar", read_caterpillar},
               {"nfg", read_nfg},       {"fastpli", read_fastpli}, {"wmg", read_wmg}};

Request read_request(conceg_ctx *ctx, const conceg_params *params) {
  const std::string floating = conceg_params_text(params, "floating"),
                    cell_class = conceg_params_text(params, "class");
  Request request = {};
  request.ctx = ctx;
  for (std::uint32_t i = 1; const char *name = conceg_params_argument(params, i); i++)
    request.names.emplace_back(name);
  request.cell_class = cell_class == "auto" ? "" : cell_class;
  request.margin_um = conceg_params_f64(params, "margin_um"),
  request.radius_min_um = conceg_params_f64(params, "radius_min_um");
  request.box_um = conceg_params_f64(params, "box_um"), request.info = conceg_params_text(params, "info");
  request.roots_are_cells = std::string(conceg_params_text(params, "roots")) == "cells";
  if (conceg_params_bool(params, "strict")) request.swc_flags |= CONCEG_SWC_STRICT;
  if (floating == "drop") request.swc_flags |= CONCEG_SWC_DROP_FLOATING;
  if (floating == "attach") request.swc_flags |= CONCEG_SWC_ATTACH_FLOATING;
  return request;
}

void import_signal(const Request &request, conceg_doc *doc, const conceg_params *params) {
  const std::vector<std::string> &names = request.names;
  if (names.size() > 1) fail(CONCEG_E_USAGE, "expected one file of signals, got %zu", names.size());
  const SignalOptions options{conceg_params_text(params, "bval"), conceg_params_text(params, "bvec"),
                              conceg_params_text(params, "compartment"),
                              conceg_params_f64(params, "pulse_duration_ms"),
                              conceg_params_f64(params, "pulse_separation_ms")};
  if (options.bval.empty() && !options.bvec.empty())
    fail(CONCEG_E_PARAM, "bvec: expected a file in bval too, got none");
  write_signals(doc, options.bval.empty() ? read_signal_table(names[0], options)
                                          : read_signal_fsl(names[0], options));
}

void import_labels(const Request &request, conceg_doc *doc, const conceg_params *params) {
  const std::string &path = only_file(request, ".npy or .npz"),
                    voxel = conceg_params_text(params, "voxel_um");
  if (voxel.empty())
    fail(CONCEG_E_PARAM,
         "voxel_um: the file does not say it; give import.voxel_um, such as 0.016,0.016,0.04");
  const LabelOptions options = {parse_voxel_um(voxel), conceg_params_f64(params, "resample_um"),
                                std::string(conceg_params_text(params, "axes")) == "zyx"};
  const NpyArray array = parse_numpy(read_bytes(request.ctx, path), path, conceg_params_text(params, "array"),
                                     static_cast<double>(conceg_ctx_memory(request.ctx)));
  write_labels(request.ctx, doc, array, options);
}

void import_files(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const char *word = conceg_params_argument(params, 0);
  if (!word)
    fail(CONCEG_E_USAGE,
         "which format? usage: conceg import FORMAT FILES-OR-FOLDERS... -o FILE.cgx; formats: %s",
         format_names(import_formats).c_str());
  const std::string format = word;
  const Request request = read_request(ctx, params);
  const bool swc = format == "swc", network = format == "network", signal = format == "signal",
             labels = format == "labels";
  Scene (*read)(const Request &) = nullptr;
  for (const auto &reader : readers)
    if (format == reader.name) read = reader.read;
  if (!swc && !network && !signal && !labels && !read)
    fail(CONCEG_E_USAGE, "%s: unknown format; there are: %s", word, format_names(import_formats).c_str());
  if (request.names.empty())
    fail(CONCEG_E_USAGE, "which files? usage: conceg import %s FILES-OR-FOLDERS... -o FILE.cgx", word);
  if (signal) return import_signal(request, doc, params);
  if (network) return import_network(request, doc);
  if (labels) return import_labels(request, doc, params);
  if (!swc) return write_document(ctx, doc, read(request), request.margin_um);
  bool restored = false;
  import_swc(request, doc, &restored);
  if (restored) conceg_params_restored(params);
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "import", [&] { import_files(ctx, doc, params); });
}

const char *const nothing[] = {nullptr};
const char *const writes[] = {"recipe",   "domain",  "provenance", "types",   "dictionary", "cells",
                              "bars",     "network", "skeleton",   "spheres", "meshes",     "volumes",
                              "protocol", "signals", "statistics", nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_import;
extern "C" const conceg_stage conceg_stage_import = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "import",
    "files",
    "1.1.0",
    "files of other programs to a document; formats: swc (SWC-plus files of conceg export give back their "
    "document), cactus, ply, "
    "caterpillar, nfg, fastpli, wmg, network, signal, labels",
    "conceg import cactus optimized_final.txt -o bundle.cgx",
    parameters,
    nothing,
    writes,
    nothing,
    CONCEG_STAGE_SOURCE | CONCEG_STAGE_ARGUMENTS | CONCEG_STAGE_RESTORES,
    nullptr,
    run};
