// SPDX-License-Identifier: BSD-3-Clause
#include "displacements.hpp"

#include "conceg/params.h"

#include <cstring>
#include <memory>

namespace conceg::analyse {

namespace {

using Recipe = std::unique_ptr<conceg_recipe, void (*)(conceg_recipe *)>;

// The parameters of the last simulation, as a recipe; null when /provenance has none.
Recipe simulation_parameters(conceg_ctx *ctx, conceg_doc *doc) {
  Recipe out(nullptr, conceg_recipe_free);
  if (!has(doc, "/provenance/stage") || !has(doc, "/provenance/parameters")) return out;
  const std::vector<std::string> stage = texts(doc, "/provenance/stage"),
                                 parameters = texts(doc, "/provenance/parameters");
  for (std::size_t i = std::min(stage.size(), parameters.size()); i-- > 0;) {
    if (stage[i] != "simulate") continue;
    conceg_recipe *parsed = nullptr;
    must(conceg_recipe_parse(ctx, ("conceg: 1\nsimulate: " + parameters[i] + "\n").c_str(),
                             "/provenance/parameters", &parsed));
    out.reset(parsed);
    break;
  }
  return out;
}

void read_media(conceg_ctx *ctx, conceg_doc *doc, Displacements &out) {
  const Recipe recipe = simulation_parameters(ctx, doc);
  if (!recipe) return;
  const conceg_node *root = conceg_recipe_root(recipe.get());
  if (const conceg_node *free = conceg_node_get(root, "simulate.diffusivity_extra"))
    must(conceg_node_f64(ctx, free, &out.free_extra));
  const conceg_node *permeability = conceg_node_get(root, "simulate.permeability");
  const char *text = permeability ? conceg_node_text(permeability) : nullptr;
  out.permeable = text && std::strcmp(text, "0") != 0;
}

} // namespace

Displacements read_displacements(conceg_ctx *ctx, conceg_doc *doc, const Cells &cells) {
  if (!has(doc, "/walkers/displacement") || !has(doc, "/walkers/time"))
    fail(CONCEG_E_MISSING,
         "diffusivity: the document has no /walkers/displacement; run conceg simulate --times-ms 0.1:100:30 "
         "before");
  must(conceg_doc_validate(doc, "/walkers", nullptr, nullptr));
  Displacements out;
  const View<double> time = view<double>(doc, "/walkers/time");
  const View<std::int64_t> cell = view<std::int64_t>(doc, "/walkers/cell");
  out.time.assign(time.begin(), time.end()), out.cell.assign(cell.begin(), cell.end());
  const std::size_t walkers = out.cell.size();
  const View<double> moved = view<double>(doc, "/walkers/displacement", 3 * walkers);
  if (moved.rows() != out.time.size())
    fail(CONCEG_E_FORMAT, "/walkers/displacement: expected %zu times, got %zu", out.time.size(),
         moved.rows());
  for (std::size_t t = 1; t < out.time.size(); t++)
    if (!(out.time[t] > out.time[t - 1]))
      fail(CONCEG_E_FORMAT, "/walkers/time[%zu]: expected more than %g ms, got %g", t, out.time[t - 1],
           out.time[t]);
  for (std::size_t w = 0; w < walkers; w++)
    if (out.cell[w] >= static_cast<std::int64_t>(cells.type.size()))
      fail(CONCEG_E_FORMAT, "/walkers/cell[%zu]: expected a row below %zu, got %lld", w, cells.type.size(),
           static_cast<long long>(out.cell[w]));
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double), "a vector of three components");
  for (std::size_t t = 0; t < out.time.size(); t++)
    out.moved.push_back(reinterpret_cast<const glm::dvec3 *>(moved.row(t)));
  if (has(doc, "/walkers/compartment")) {
    const View<std::uint8_t> code = view<std::uint8_t>(doc, "/walkers/compartment");
    if (code.rows() != walkers)
      fail(CONCEG_E_FORMAT, "/walkers/compartment: expected %zu values, got %zu", walkers, code.rows());
    out.compartment.assign(code.begin(), code.end());
  }
  read_media(ctx, doc, out);
  return out;
}

} // namespace conceg::analyse
