// SPDX-License-Identifier: BSD-3-Clause
#include "structure_stage.hpp"

#include "output.hpp"
#include "structure_report.hpp"

#include <memory>

namespace conceg::analyse {
namespace {

struct Close {
  void operator()(conceg_doc *doc) const { (void)conceg_doc_close(doc); } // only read from
};
using Document = std::unique_ptr<conceg_doc, Close>;

Document open(conceg_ctx *ctx, const std::string &path) {
  conceg_doc *raw = nullptr;
  must(conceg_doc_open(ctx, path.c_str(), &raw));
  return Document(raw);
}

std::vector<std::string> split(const std::string &list) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (end > begin) out.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

void tell_left_out(conceg_ctx *ctx, const StructureInput &input, const StructureResult &r) {
  if (input.told_of_all && r.donors)
    conceg_ctx_log(
        ctx, CONCEG_LOG_WARNING,
        "analyse: structure: %s: its dictionary also holds the donors held back, and growth was told "
        "the straightness of all; characterise the others alone",
        r.entry.c_str());
  if (r.grown_left_out)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "analyse: structure: %s: %zu grown cells are left out: their set has no real cell",
                   r.entry.c_str(), r.grown_left_out);
  if (r.real_left_out)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "analyse: structure: %s: %zu real cells are left out: their set has no grown cell",
                   r.entry.c_str(), r.real_left_out);
}

} // namespace

void drop_structure(conceg_doc *doc) {
  for (const char *name : {"structure", "structure_means", "structure_quantile", "structure_cell",
                           "structure_branch", "structure_donor"})
    must(conceg_doc_drop(doc, (std::string("/statistics/") + name).c_str()));
}

void measure_structure(conceg_ctx *ctx, conceg_doc *doc, const StructureOptions &options, const Cells &cells,
                       const Skeletons &skeletons, Workers &workers) {
  if (options.real.empty())
    fail(CONCEG_E_PARAM, "structure_pool and structure_dir: expected structure, the document of real cells");
  if (!options.folder.empty()) make_folder(options.folder);
  const Progress progress = progress_of(ctx);
  StructureInput input;
  add_document(input, doc, cells, skeletons, open(ctx, options.real).get(), options.real, workers, progress);
  for (const std::string &path : split(options.pool))
    add_analysed(input, open(ctx, path).get(), path);
  StructureSettings settings;
  settings.seed = conceg_ctx_seed(ctx);
  std::vector<StructureResult> results;
  for (const StructureGroup &group : input.groups) {
    results.push_back(compare_structure(group, settings, workers, progress));
    tell_left_out(ctx, input, results.back());
  }
  std::vector<Table> tables = structure_value_tables(input);
  for (const Table &table :
       {structure_table(results), structure_means_table(results), structure_quantile_table(results)})
    tables.push_back(table);
  for (const Table &table : tables) {
    if (!table.rows()) continue;
    write_table(doc, table);
    if (options.folder.empty()) continue;
    OutputFile file(options.folder + "/" + table.name + ".csv");
    file.write(table.csv()), file.commit();
  }
  const std::vector<std::string> lines = structure_lines(input, results);
  for (const std::string &line : lines)
    conceg_ctx_log(ctx, CONCEG_LOG_RESULT, "%s", line.c_str());
  if (options.folder.empty()) return;
  OutputFile text(options.folder + "/structure.txt");
  for (const std::string &line : lines)
    text.write(line + "\n");
  text.commit();
  draw_structure(options.folder, results);
}

} // namespace conceg::analyse
