// SPDX-License-Identifier: BSD-3-Clause
// The grow stage: /domain /types /cells /bars /network -> /skeleton, and what became of each bar in /bars.
#include "conceg/stage.h"

#include "deliver.hpp"
#include "entries.hpp"
#include "grow.hpp"
#include "input.hpp"
#include "view.hpp"
#include "wrap.hpp"

#include <chrono>
#include <cstdio>
#include <cstring>

namespace {

using namespace conceg;
using namespace conceg::grow;

const conceg_param parameter_table[] = {
    {"f", "1", "weight of the radius term: l = l_t + f l_r", "1", nullptr, CONCEG_PARAM_F64, 0, 0.0, 100.0},
    {"length_factor", "",
     "factor |s-c| / (1 + |s-c|) in l_t as the paper prints it; it favours short sideways edges", "false",
     nullptr, CONCEG_PARAM_BOOL, 0, 0.0, 0.0},
    {"lambda_per_um", "um^-1", "steepness of the forks' hazard before a bar's start", "2", nullptr,
     CONCEG_PARAM_F64, 0, 0.01, 100.0},
    {"hazard", "", "forks by a hazard per um of path, or by the paper's probability at each step", "per_um",
     "per_um|per_step", CONCEG_PARAM_CHOICE, 0, 0.0, 0.0},
    {"g0_um", "um",
     "length that the first collapse of a trapped projection removes; the k-th removes k times as much", "5",
     nullptr, CONCEG_PARAM_F64, 0, 0.5, 1000.0},
    {"retries", "1", "collapses in one place, and places tried for a fork, before a bar is given up", "5",
     nullptr, CONCEG_PARAM_I64, 0, 0.0, 1000.0},
    {"r_min_um", "um", "no process is thinner", "0.15", nullptr, CONCEG_PARAM_F64, 0, 0.01, 10.0},
    {"radius_fraction", "1",
     "radius committed in growth over the target radius; the cost sees the whole target", "0.6", nullptr,
     CONCEG_PARAM_F64, 0, 0.05, 1.0},
    {"smoothing", "1",
     "how far the line leaves the nodes for the smoothed place, inside the free space; 0 = none", "0.5",
     nullptr, CONCEG_PARAM_F64, 0, 0.0, 1.0},
    {"straightness", "",
     "steered to each entry's by more smoothing or by wandering, or free: the same smoothing for all",
     "dictionary", "dictionary|free", CONCEG_PARAM_CHOICE, 0, 0.0, 0.0},
    {"occupancy", "", "what keeps cells apart: exact capsules, or the nodes' free radius alone (the paper)",
     "capsule", "capsule|nodes", CONCEG_PARAM_CHOICE, 0, 0.0, 0.0},
    {"calibre", "", "radius along a bar: its taper times the entry's Gaussian process, or the taper alone",
     "process", "process|taper", CONCEG_PARAM_CHOICE, 0, 0.0, 0.0},
    {"max_edge_um", "um", "longer edges of the network are no candidates", "2", nullptr, CONCEG_PARAM_F64, 0,
     0.5, 3.0},
    {"finish", "",
     "where the document has grown cells, carry on the bars that did not reach their ends instead of growing "
     "anew (second growth, after relax); the recipe must keep: [network]",
     "false", nullptr, CONCEG_PARAM_BOOL, 0, 0.0, 0.0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0.0, 0.0},
};

Parameters read_parameters(const conceg_params *params) {
  Parameters parameters;
  parameters.f = conceg_params_f64(params, "f");
  parameters.length_factor = conceg_params_bool(params, "length_factor") != 0;
  parameters.lambda_per_um = conceg_params_f64(params, "lambda_per_um");
  parameters.hazard =
      std::strcmp(conceg_params_text(params, "hazard"), "per_step") == 0 ? Hazard::per_step : Hazard::per_um;
  parameters.collapse_um = conceg_params_f64(params, "g0_um");
  parameters.retries = static_cast<std::uint32_t>(conceg_params_i64(params, "retries"));
  parameters.r_min_um = conceg_params_f64(params, "r_min_um");
  parameters.radius_fraction = conceg_params_f64(params, "radius_fraction");
  parameters.smoothing = conceg_params_f64(params, "smoothing");
  parameters.occupancy = std::strcmp(conceg_params_text(params, "occupancy"), "nodes") == 0
                             ? Occupancy::nodes
                             : Occupancy::capsule;
  parameters.max_edge_um = conceg_params_f64(params, "max_edge_um");
  return parameters;
}

void write_skeleton(conceg_doc *doc, const Skeleton &skeleton) {
  put(doc, "/skeleton/cell_offset", skeleton.cell_offset);
  put3(doc, "/skeleton/position", skeleton.position);
  put(doc, "/skeleton/radius", skeleton.radius);
  put(doc, "/skeleton/target_radius", skeleton.target_radius);
  put(doc, "/skeleton/parent", skeleton.parent);
  put(doc, "/skeleton/kind", skeleton.kind);
  put(doc, "/skeleton/branch", skeleton.branch);
  put(doc, "/skeleton/bar", skeleton.bar);
  put(doc, "/skeleton/tree", skeleton.tree);
  put(doc, "/skeleton/status", skeleton.status);
}

void write_bars(conceg_doc *doc, const BarReport &report) {
  put(doc, "/bars/achieved_start", report.achieved_start);
  put(doc, "/bars/achieved_end", report.achieved_end);
  put(doc, "/bars/state", report.state);
  put(doc, "/bars/handed_to", report.handed_to);
}

void tell_straightness(conceg_ctx *ctx, const Types &types, const Measures &measures) {
  for (std::size_t type = 0; type < types.name.size(); type++) {
    const Straightness &reached = measures.of_type[type];
    if (reached.branches == 0) continue;
    const double asked = type < types.straightness.size() ? types.straightness[type] : 0.0;
    char ask[32] = "none asked";
    if (asked > 0.0) std::snprintf(ask, sizeof ask, "%.3f asked", asked);
    conceg_ctx_log(ctx, CONCEG_LOG_INFO, "grow: %s: straightness %.3f, %s, %llu branches",
                   types.name[type].c_str(), reached.mean(), ask,
                   static_cast<unsigned long long>(reached.branches));
  }
}

void tell(conceg_ctx *ctx, const State &state, const Summary &summary, const Measures &measures,
          double seconds) {
  for (std::uint32_t worker = 0; worker < summary.steps_by_worker.size() && worker < 256; worker++)
    conceg_ctx_count(ctx, "grow.steps", worker, summary.steps_by_worker[worker]);
  conceg_ctx_count(ctx, "grow.rounds", 0, summary.rounds);
  conceg_ctx_count(ctx, "grow.deferred", 0, summary.deferred);
  conceg_ctx_count(ctx, "grow.collapses", 0, summary.collapses);
  const double box = volume(state.input.box);
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "grow: %llu steps (%.0f/s), %llu collapses, %llu deferred; bars: %llu done, %llu short, %llu lost, "
      "%llu handed on; "
      "cable %.3f mm, straightness %.3f, fork angle off by %.1f deg, ICVF about %.3f committed, %.3f at "
      "target",
      static_cast<unsigned long long>(summary.steps),
      seconds > 0.0 ? static_cast<double>(summary.steps) / seconds : 0.0,
      static_cast<unsigned long long>(summary.collapses), static_cast<unsigned long long>(summary.deferred),
      static_cast<unsigned long long>(summary.done), static_cast<unsigned long long>(summary.cut_short),
      static_cast<unsigned long long>(summary.lost), static_cast<unsigned long long>(summary.handed),
      measures.cable_um * 1e-3, measures.straightness, summary.angle_error * 57.29577951308232,
      measures.volume_committed_um3 / box, measures.volume_target_um3 / box);
  tell_straightness(ctx, state.input.types, measures);
  if (summary.lost > 0)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "grow: %llu of %zu bars found no room and were lost (state 3 in /bars); a lower density "
                   "or radius_scale leaves more room",
                   static_cast<unsigned long long>(summary.lost), state.input.bars.count);
}

void tell_free_cable(conceg_ctx *ctx, const State &state, const FreeCable &cable) {
  if (cable.cells == 0) return;
  const double box = volume(state.input.box);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "grow: %llu cells without soma (passing axons): %.4f um of cable per um3 asked, %.4f grown; "
                 "%llu short, %llu found no free start",
                 static_cast<unsigned long long>(cable.cells), cable.asked_um / box, cable.grown_um / box,
                 static_cast<unsigned long long>(cable.cut_short),
                 static_cast<unsigned long long>(cable.lost));
}

// A note at each tenth of the cable: how much stands, how many cells are done, when it will be over.
Watch tell_tenths(conceg_ctx *ctx, const State &state) {
  const auto began = std::chrono::steady_clock::now();
  Watch watch;
  watch.tenth = [ctx, &state, began](const Standing &standing) {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
    const double left = spent.count() * (standing.asked_um / standing.cable_um - 1.0);
    conceg_ctx_log(
        ctx, CONCEG_LOG_INFO,
        "grow: %.3f of %.3f mm of cable, %zu of %zu cells done, %.3f of the box occupied, %.0f s left",
        1e-3 * standing.cable_um, 1e-3 * standing.asked_um, standing.cells_done, standing.cells,
        standing.occupied_um3 / volume(state.input.box), left > 0.0 ? left : 0.0);
  };
  return watch;
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "grow", [&] {
    Phases phases;
    State state;
    state.parameters = read_parameters(params);
    state.input = read_input(doc, conceg_ctx_seed(ctx));
    const bool finish = conceg_params_bool(params, "finish") != 0;
    if (finish)
      read_earlier(doc, state.input);
    else if (has(doc, "/skeleton"))
      must(conceg_doc_drop(doc, "/skeleton"));
    check_spacing(state.input, state.parameters.max_edge_um);
    read_entries(doc, std::strcmp(conceg_params_text(params, "straightness"), "dictionary") == 0,
                 std::strcmp(conceg_params_text(params, "calibre"), "process") == 0, state.input);
    phases.end("input");
    const Summary summary =
        conceg::grow::grow(state, conceg_ctx_threads(ctx), progress_of(ctx), phases, tell_tenths(ctx, state));
    const double seconds = phases.wall_s();
    const Skeleton skeleton = deliver_skeleton(state);
    const BarReport report = deliver_bars(state);
    tell(ctx, state, summary, measure(state, skeleton), seconds);
    tell_free_cable(ctx, state, measure_free_cable(state, report));
    write_bars(doc, report);
    write_skeleton(doc, skeleton);
    phases.end("deliver");
    tell_phases(ctx, "grow", phases, summary.busy_s, conceg_ctx_threads(ctx));
  });
}

const char *const reads[] = {"domain", "types", "cells", "bars", "network", "?skeleton", nullptr};
const char *const writes[] = {"skeleton", "bars", "network",
                              nullptr}; // the network as it was, when it is kept
const char *const drops[] = {"network", nullptr};

} // namespace

extern "C" const CONCEG_EXPORT conceg_stage conceg_stage_grow;
extern "C" const conceg_stage conceg_stage_grow = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "grow",
    "barcode",
    "1.0.0",
    "grows every bar of every cell through the network: cost, occupancy, branching, collapse",
    "conceg place -p cube.yaml | conceg triangulate | conceg grow > grown.cgx",
    parameter_table,
    reads,
    writes,
    drops,
    CONCEG_STAGE_THREADED,
    nullptr,
    run,
};
