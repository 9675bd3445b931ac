// SPDX-License-Identifier: BSD-3-Clause
// The report stage: one HTML page with all that a document says of its tissue.
#include "conceg/stage.h"
#include "facts.hpp"
#include "guard.hpp"
#include "page.hpp"
#include "scene.hpp"

#include "conceg/conceg.h"

namespace {

using namespace conceg;
using namespace conceg::reporting;

const conceg_param parameters[] = {
    {"page", "", "the page to write; conceg report also takes it from -o when that ends in .html",
     "report.html", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"size_mb", "MB",
     "most that skeletons and surfaces take of the page; what does not fit is thinned or left out, and the "
     "page "
     "says so",
     "20", nullptr, CONCEG_PARAM_F64, 0, 0.01, 500},
    {"rows", "", "most rows of a table; the page says how many are left out", "2000", nullptr,
     CONCEG_PARAM_I64, 0, 1, 1000000},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

std::string page_of(const conceg_params *params) {
  std::string path = conceg_params_text(params, "page");
  if (path.empty()) fail(CONCEG_E_PARAM, "page: expected the name of a file, got an empty text");
  return path;
}

// What killed runs have left in the page's folder goes.
void sweep(const std::string &path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  (void)!conceg_clean(nullptr, folder.c_str(), 0, nullptr, nullptr);
}

conceg_status check(conceg_ctx *ctx, conceg_doc *, const conceg_params *params) {
  return guard(ctx, "report", [&] { (void)page_of(params); });
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "report", [&] {
    const std::string path = page_of(params);
    sweep(path);
    OutputFile file(path); // a folder that cannot be written to is refused before any work
    // Four characters of the page hold three bytes.
    const auto most = static_cast<std::size_t>(conceg_params_f64(params, "size_mb") * 1e6 * 0.75);
    must(conceg_ctx_progress(ctx, "gathering", 0, 3));
    Json json;
    json.open('{').key("version").text(conceg_version());
    put_facts(doc, static_cast<std::uint64_t>(conceg_params_i64(params, "rows")), json);
    must(conceg_ctx_progress(ctx, "gathering", 1, 3));
    const Scene scene = read_scene(doc, most);
    must(conceg_ctx_progress(ctx, "gathering", 2, 3));
    const std::vector<Block> blocks = pack(scene, json);
    json.close('}');
    write_page(file, json.str(), blocks);
    file.commit();
    must(conceg_ctx_progress(ctx, "gathering", 3, 3));
    for (const std::string &line : scene.left_out)
      conceg_ctx_log(ctx, CONCEG_LOG_INFO, "report: %s", line.c_str());
    conceg_ctx_log(ctx, CONCEG_LOG_RESULT, "report: wrote %s", path.c_str());
  });
}

const char *const reads[] = {"?domain",     "?types",      "?cells",   "?skeleton", "?meshes",
                             "?volumes",    "?protocol",   "?walkers", "?signals",  "?statistics",
                             "?provenance", "?dictionary", nullptr};
const char *const nothing[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_report;
extern "C" const conceg_stage conceg_stage_report = {CONCEG_STAGE_ABI,
                                                     sizeof(conceg_stage),
                                                     "report",
                                                     "page",
                                                     "1.0.0",
                                                     "writes one HTML page: the cells in 3-D, every table "
                                                     "and signal as a chart, the recipe that makes it again",
                                                     "conceg report cube.cgx -o report.html",
                                                     parameters,
                                                     reads,
                                                     nothing,
                                                     nothing,
                                                     CONCEG_STAGE_SINK,
                                                     check,
                                                     run};
