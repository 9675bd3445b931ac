// SPDX-License-Identifier: BSD-3-Clause
// import: files of other programs, or of our own export, -> a document.
#include "conceg/stage.h"
#include "guard.hpp"
#include "signal_document.hpp"
#include "swc_files.hpp"

#include <cstring>

namespace {

using namespace conceg;
using namespace conceg::importing;

const conceg_param parameters[] = {
    {"class", "",
     "plain files: class of the cells; auto = pyramidal with a type-4 sample, astrocyte with a type-7 one, "
     "else other",
     "auto", "auto|pyramidal|interneuron|astrocyte|microglia|axon|other", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"margin_um", "um", "plain files: space between the cells and the sides of the box", "5", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1e6},
    {"radius_min_um", "um", "plain files: smaller radii are raised to this; 0 = a radius of 0 is an error",
     "0", nullptr, CONCEG_PARAM_F64, 0, 0, 100},
    {"floating", "", "trees that are not joined to the soma", "keep", "keep|drop|attach", CONCEG_PARAM_CHOICE,
     0, 0, 0},
    {"strict", "", "read SWC strictly: warnings marked S are errors", "false", nullptr, CONCEG_PARAM_BOOL, 0,
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
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

constexpr const char *usage =
    "usage: conceg import swc FILES-OR-FOLDERS... -o FILE.cgx, or conceg import signal FILE -o "
    "FILE.cgx";

// The words after the format.
std::vector<std::string> read_names(const conceg_params *params) {
  std::vector<std::string> names;
  for (std::uint32_t i = 1; const char *name = conceg_params_argument(params, i); i++)
    names.emplace_back(name);
  if (names.empty()) fail(CONCEG_E_USAGE, "which files? %s", usage);
  return names;
}

void import_signal(conceg_doc *doc, const conceg_params *params) {
  const std::vector<std::string> names = read_names(params);
  if (names.size() > 1)
    fail(CONCEG_E_USAGE, "expected one file of signals, got %zu; %s", names.size(), usage);
  const SignalOptions options{conceg_params_text(params, "bval"), conceg_params_text(params, "bvec"),
                              conceg_params_text(params, "compartment"),
                              conceg_params_f64(params, "pulse_duration_ms"),
                              conceg_params_f64(params, "pulse_separation_ms")};
  if (options.bval.empty() && !options.bvec.empty())
    fail(CONCEG_E_PARAM, "bvec: expected a file in bval too, got none");
  write_signals(doc, options.bval.empty() ? read_signal_table(names[0], options)
                                          : read_signal_fsl(names[0], options));
}

void import_swc(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const std::string floating = conceg_params_text(params, "floating"),
                    cell_class = conceg_params_text(params, "class");
  std::uint32_t flags = conceg_params_bool(params, "strict") ? CONCEG_SWC_STRICT : 0;
  if (floating == "drop") flags |= CONCEG_SWC_DROP_FLOATING;
  if (floating == "attach") flags |= CONCEG_SWC_ATTACH_FLOATING;
  std::vector<SwcFile> files = read_files(ctx, find_files(read_names(params)), flags);
  bool blocks = false;
  for (const SwcFile &file : files)
    blocks = blocks || file.blocks.present;
  if (blocks) {
    if (restore_document(ctx, doc, files)) conceg_params_restored(params);
  } else
    make_document(ctx, doc, files,
                  {cell_class == "auto" ? "" : cell_class, conceg_params_f64(params, "margin_um"),
                   conceg_params_f64(params, "radius_min_um")});
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "import", [&] {
    const char *format = conceg_params_argument(params, 0);
    if (!format) fail(CONCEG_E_USAGE, "which format? %s", usage);
    if (!std::strcmp(format, "swc"))
      import_swc(ctx, doc, params);
    else if (!std::strcmp(format, "signal"))
      import_signal(doc, params);
    else
      fail(CONCEG_E_USAGE, "%s: unknown format; there is: swc and signal; %s", format, usage);
  });
}

const char *const nothing[] = {nullptr};
const char *const writes[] = {"recipe",   "domain",  "provenance", "types",   "dictionary", "cells", "bars",
                              "skeleton", "spheres", "protocol",   "signals", "statistics", nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_import;
extern "C" const conceg_stage conceg_stage_import = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "import",
    "files",
    "1.0.0",
    "files of other programs to a document: swc (SWC-plus files give back their document), signal (CSV, FSL)",
    "conceg import swc cells -o cells.cgx",
    parameters,
    nothing,
    writes,
    nothing,
    CONCEG_STAGE_SOURCE | CONCEG_STAGE_ARGUMENTS | CONCEG_STAGE_RESTORES,
    nullptr,
    run};
