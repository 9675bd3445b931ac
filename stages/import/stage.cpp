// SPDX-License-Identifier: BSD-3-Clause
// import: files of other programs, or of our own export, -> a document.
#include "conceg/stage.h"
#include "guard.hpp"
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
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

std::vector<std::string> read_words(const conceg_params *params) {
  const char *format = conceg_params_argument(params, 0);
  if (!format) fail(CONCEG_E_USAGE, "which format? usage: conceg import swc FILES-OR-FOLDERS... -o FILE.cgx");
  if (std::strcmp(format, "swc") != 0)
    fail(CONCEG_E_USAGE, "%s: unknown format; there is: swc (conceg import swc FILES-OR-FOLDERS...)", format);
  std::vector<std::string> names;
  for (std::uint32_t i = 1; const char *name = conceg_params_argument(params, i); i++)
    names.emplace_back(name);
  if (names.empty())
    fail(CONCEG_E_USAGE, "which files? usage: conceg import swc FILES-OR-FOLDERS... -o FILE.cgx");
  return names;
}

void import_swc(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const std::string floating = conceg_params_text(params, "floating"),
                    cell_class = conceg_params_text(params, "class");
  std::uint32_t flags = conceg_params_bool(params, "strict") ? CONCEG_SWC_STRICT : 0;
  if (floating == "drop") flags |= CONCEG_SWC_DROP_FLOATING;
  if (floating == "attach") flags |= CONCEG_SWC_ATTACH_FLOATING;
  std::vector<SwcFile> files = read_files(ctx, find_files(read_words(params)), flags);
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
  return guard(ctx, "import", [&] { import_swc(ctx, doc, params); });
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
    "files of other programs to a document: swc (SWC-plus files of conceg export give back their document)",
    "conceg import swc cells -o cells.cgx",
    parameters,
    nothing,
    writes,
    nothing,
    CONCEG_STAGE_SOURCE | CONCEG_STAGE_ARGUMENTS | CONCEG_STAGE_RESTORES,
    nullptr,
    run};
