// SPDX-License-Identifier: BSD-3-Clause
#include "diffusivity_measure.hpp"

#include "diffusivity.hpp"
#include "output.hpp"

namespace conceg::analyse {

namespace {

void log_lines(conceg_ctx *ctx, const Table &table) {
  conceg_ctx_log(ctx, CONCEG_LOG_INFO, "--- %s", table.name.c_str());
  for (const std::string &line : table.lines())
    conceg_ctx_log(ctx, CONCEG_LOG_INFO, "%s", line.c_str());
}

} // namespace

void measure_diffusivity(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params, const Cells &cells,
                         const Transport *limit, const Transport *fine, Workers &workers) {
  const Displacements walked = read_displacements(ctx, doc, cells);
  if (walked.time.empty()) return;
  const double last = walked.time.back(), from = conceg_params_f64(params, "tail_from_ms"),
               to = conceg_params_f64(params, "tail_to_ms");
  const TailRange range = {from > 0 ? from : 0.1 * last, to > 0 ? to : last};
  if (!(range.from < range.to))
    fail(CONCEG_E_PARAM, "tail_from_ms: expected less than tail_to_ms (%g), got %g", range.to, range.from);
  const std::vector<Diffusivity> found = diffusivities(walked, cells, range, workers);
  const WalkedLambda lambda = walked_lambda(found, walked);
  if (lambda.state != "fitted")
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "analyse: lambda_walkers: %s", lambda.state.c_str());
  const std::string folder = conceg_params_text(params, "csv");
  if (!folder.empty()) make_folder(folder);
  for (const Table &table : {diffusivity_table(found, walked.time), diffusivity_fit_table(found, range),
                             lambda_table(lambda, limit, fine)}) {
    if (!table.rows()) continue;
    write_table(doc, table);
    if (table.name != "diffusivity") log_lines(ctx, table);
    if (folder.empty()) continue;
    OutputFile file(folder + "/" + table.name + ".csv");
    file.write(table.csv()), file.commit();
  }
}

} // namespace conceg::analyse
