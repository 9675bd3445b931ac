// SPDX-License-Identifier: BSD-3-Clause
// check: descriptor and glue. Looks at a document with every gate and writes what they say.
#include "gates.hpp"

#include "conceg/conceg.h"

#include "view.hpp"

namespace {

using namespace conceg;
using namespace conceg::gates;

const conceg_param parameters[] = {
    {"icvf_tolerance", "1", "largest difference of two measures of the volume fraction", "0.005", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1},
    {"cell_tolerance", "1", "largest relative difference of a cell's volume by labels and by its surface",
     "0.05", nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"least_cable", "1", "least share of the cable asked for that must have been grown", "0.8", nullptr,
     CONCEG_PARAM_F64, 0, 0, 1},
    {"most_detached", "1", "largest share of the cells' volume that the meshes may leave out", "0.01",
     nullptr, CONCEG_PARAM_F64, 0, 0, 1},
    {"least_gap_um", "um", "between surfaces; 0 = half of the gap that the meshes were made with", "0",
     nullptr, CONCEG_PARAM_F64, 0, 0, 10},
    {"points", "1", "located at random in the surfaces; 0 = none", "1000000", nullptr, CONCEG_PARAM_I64, 0, 0,
     1e9},
    {"space", "", "look for the pieces of the extracellular space; takes as long as marching the grid",
     "true", nullptr, CONCEG_PARAM_BOOL, 0, 0, 0},
    {"stop", "", "a gate that failed ends the run, as a stage that fails", "false", nullptr,
     CONCEG_PARAM_BOOL, 0, 0, 0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};

// Values have the unit of their row's text.
void put_values(conceg_doc *doc, const char *path, const std::vector<double> &values) {
  conceg_array array = {};
  array.size = sizeof array;
  array.dtype = CONCEG_F64, array.rank = 1, array.shape[0] = values.size();
  array.data = values.data(), array.unit = "1";
  must(conceg_doc_write(doc, path, &array));
}

void write_gates(conceg_doc *doc, const Gates &gates) {
  std::vector<std::string> group, name, verdict, unit, rule, note;
  std::vector<double> value;
  for (const Gate &gate : gates.all()) {
    group.push_back(gate.group), name.push_back(gate.name), verdict.push_back(verdict_name(gate.verdict));
    value.push_back(gate.value), unit.push_back(gate.unit), rule.push_back(gate.rule),
        note.push_back(gate.note);
  }
  must(conceg_doc_drop(doc, "/statistics/gates"));
  put_texts(doc, "/statistics/gates/group", group);
  put_texts(doc, "/statistics/gates/gate", name);
  put_texts(doc, "/statistics/gates/verdict", verdict);
  put_values(doc, "/statistics/gates/value", value);
  put_texts(doc, "/statistics/gates/value_unit", unit);
  put_texts(doc, "/statistics/gates/rule", rule);
  put_texts(doc, "/statistics/gates/looked_at", note);
}

void check_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  Limits limits;
  limits.icvf = conceg_params_f64(params, "icvf_tolerance");
  limits.cell_volume = conceg_params_f64(params, "cell_tolerance");
  limits.cable = conceg_params_f64(params, "least_cable");
  limits.detached = conceg_params_f64(params, "most_detached");
  limits.least_gap_um = conceg_params_f64(params, "least_gap_um");
  limits.points = static_cast<std::uint64_t>(conceg_params_i64(params, "points"));
  limits.space = conceg_params_bool(params, "space") != 0;
  limits.check_memory = std::min<std::size_t>(1u << 30, conceg_ctx_memory(ctx) / 4);
  Workers workers(conceg_ctx_threads(ctx));
  const Progress progress = progress_of(ctx);
  Gates gates;
  format_gates(doc, gates);
  cell_gates(doc, gates);
  skeleton_gates(doc, gates);
  bar_gates(doc, limits, gates);
  surface_gates(doc, limits, workers, progress, gates);
  label_gates(doc, workers, gates);
  volume_gates(ctx, doc, limits, workers, gates);
  space_gates(doc, limits, workers, progress, gates);
  walk_gates(doc, gates);
  workers.count(ctx, "check.items");
  write_gates(doc, gates);
  if (!gates.count(Verdict::failed) || !conceg_params_bool(params, "stop")) return;
  for (const Gate &gate : gates.all())
    if (gate.verdict == Verdict::failed)
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "check: %s: %s: expected %s, got %g; %s", gate.group.c_str(),
                     gate.name.c_str(), gate.rule.c_str(), gate.value, gate.note.c_str());
  fail(CONCEG_E_STAGE, "%zu of %zu gates failed", gates.count(Verdict::failed), gates.all().size());
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "check", [&] { check_document(ctx, doc, params); });
}

const char *const reads[] = {"domain", "types", "cells", nullptr};
const char *const writes[] = {"statistics", nullptr};
const char *const drops[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_check;
const conceg_stage conceg_stage_check = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "check",
    "gates",
    "1.0.0",
    "says whether a document keeps all that any figure drawn from it rests on",
    "conceg check cube.cgx && echo sound",
    parameters,
    reads,
    writes,
    drops,
    CONCEG_STAGE_THREADED,
    nullptr,
    run,
};
