// SPDX-License-Identifier: BSD-3-Clause
// The simulate stage: walkers between the membranes of a document, and the signals that they give.
#include "checkpoint.hpp"
#include "files.hpp"
#include "scheme_files.hpp"
#include "settings.hpp"
#include "simulation.hpp"
#include "tissue.hpp"
#include "view.hpp"

#include "conceg/stage.h"

#include <glm/geometric.hpp>

#include <chrono>
#include <map>

namespace {

using namespace conceg;
using namespace conceg::simulate;

unsigned long long whole(std::uint64_t n) {
  return n;
}

Protocol make_protocol(const conceg_params *params) {
  Pulses times;
  times.duration_ms = conceg_params_f64(params, "delta_ms"),
  times.separation_ms = conceg_params_f64(params, "separation_ms");
  if (!(times.separation_ms >= times.duration_ms))
    fail(CONCEG_E_PARAM, "separation_ms: expected at least delta_ms = %g, got %g", times.duration_ms,
         times.separation_ms);
  const double asked = conceg_params_f64(params, "echo_ms"), least = times.duration_ms + times.separation_ms;
  if (asked > 0.0 && asked < least)
    fail(CONCEG_E_PARAM, "echo_ms: expected at least delta + Delta = %g, got %g", least, asked);
  times.echo_ms = asked > 0.0 ? asked : least;
  const std::string file = conceg_params_text(params, "protocol");
  if (!file.empty()) return read_protocol(file, times);
  std::vector<Pulses> rows;
  const std::vector<glm::dvec3> directions =
      spread_directions(static_cast<std::size_t>(conceg_params_i64(params, "directions")));
  for (const double b : numbers("b", conceg_params_text(params, "b"), 0.0, 1000.0)) {
    times.b = b;
    for (const glm::dvec3 &n : directions) {
      times.direction = n;
      rows.push_back(times);
      if (!(b > 0.0)) break;
    }
  }
  if (rows.empty()) fail(CONCEG_E_PARAM, "b: expected at least one b-value, got none");
  return pulsed(rows);
}

Physics make_physics(conceg_ctx *ctx, const conceg_params *params, const Tissue &tissue,
                     const Protocol &protocol) {
  Physics p;
  const auto medium = [&](const char *diffusivity, const char *t2) {
    const double time = conceg_params_f64(params, t2);
    return Medium{conceg_params_f64(params, diffusivity), time > 0.0 ? 1.0 / time : 0.0};
  };
  p.intra = medium("diffusivity_intra", "t2_intra_ms"), p.extra = medium("diffusivity_extra", "t2_extra_ms");
  p.step_ms = conceg_params_f64(params, "step_ms");
  p.jumps = p.skip = std::string(conceg_params_text(params, "method")) == "jumps";
  p.permeability = face_permeability(conceg_params_text(params, "permeability"), tissue.membranes.code);
  const double step = std::max(step_length(p.intra, p.step_ms), step_length(p.extra, p.step_ms));
  for (const double kappa : p.permeability) {
    const double chance = 2.0 * kappa * step / (3.0 * std::min(p.intra.diffusivity, p.extra.diffusivity));
    if (!(chance <= 0.1))
      fail(CONCEG_E_RANGE,
           "permeability: expected at most 0.1 as chance of passage at a contact, got %g at %g um/ms; use a "
           "shorter step_ms",
           chance, kappa);
  }
  if (tissue.thinnest_um > 0.0 && step > tissue.thinnest_um)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "simulate: a step is %.3f um long, the thinnest process has a radius of %.3f um: signals "
                   "of such processes "
                   "are off; use a step_ms of %.2g or below",
                   step, tissue.thinnest_um, p.step_ms * std::pow(0.5 * tissue.thinnest_um / step, 2.0));
  const bool relaxes = p.intra.relaxation_rate > 0.0 || p.extra.relaxation_rate > 0.0;
  for (const double echo : protocol.echo_time)
    if (relaxes && std::fabs(echo - protocol.echo_time.front()) > 1e-6)
      fail(CONCEG_E_UNSUPPORTED,
           "t2_intra_ms, t2_extra_ms: expected a protocol of one echo time, got %g and %g ms; simulate each "
           "by itself",
           protocol.echo_time.front(), echo);
  return p;
}

Wanted make_wanted(const conceg_params *params, const Tissue &tissue) {
  const std::string compartment = conceg_params_text(params, "compartment");
  Wanted w;
  w.margin_um = conceg_params_f64(params, "margin_um");
  w.extra = compartment != "intra";
  w.cells = tissue.chosen(conceg_params_text(params, "cells"), conceg_params_text(params, "kind"));
  if (compartment == "extra") std::fill(w.cells.begin(), w.cells.end(), std::uint8_t{0});
  return w;
}

// Codes of where walkers begin: the soma's sphere, else what the nearest face says.
std::vector<std::uint8_t> codes(const Tissue &tissue, const Walls &walls, const Seeds &seeds,
                                Workers &workers) {
  std::vector<std::uint8_t> out(seeds.position.size(), CONCEG_ECS);
  workers.loop(out.size(), 256, [&](std::size_t i, unsigned) {
    if (seeds.cell[i] < 0) return;
    const Soma &soma = tissue.soma[static_cast<std::size_t>(seeds.cell[i])];
    const bool in_soma = glm::length(nearest(tissue.box, seeds.position[i] - soma.centre)) < soma.radius;
    out[i] = in_soma ? std::uint8_t{CONCEG_SOMA} : walls.nearest_code(walls.local(seeds.position[i]));
  });
  return out;
}

std::vector<Compartment> compartments(const Tissue &tissue, const Seeds &seeds,
                                      const std::vector<std::uint8_t> &code) {
  std::vector<Compartment> out = {{"all", {}}, {"intra", {}}, {"extra", {}}, {"soma", {}}, {"neurite", {}}};
  std::map<std::string, Compartment> types;
  for (std::uint32_t i = 0; i < seeds.cell.size(); i++) {
    out[0].walker.push_back(i);
    if (seeds.cell[i] < 0) {
      out[2].walker.push_back(i);
      continue;
    }
    out[1].walker.push_back(i), out[code[i] == CONCEG_SOMA ? 3 : 4].walker.push_back(i);
    const std::string name = "type " + tissue.type_name[static_cast<std::size_t>(seeds.cell[i])];
    types[name].name = name, types[name].walker.push_back(i);
  }
  for (auto &[name, type] : types)
    out.push_back(std::move(type));
  const bool both = !out[1].walker.empty() && !out[2].walker.empty();
  std::vector<Compartment> kept;
  for (Compartment &c : out)
    if (!c.walker.empty() && (c.name != "all" || both)) kept.push_back(std::move(c));
  return kept;
}

// Walkers a second of one thread, by a few of them over the first part of the timeline.
double try_rate(const Plan &plan, const Walls &walls, const Seeds &seeds) {
  std::vector<Start> start;
  for (std::size_t i = 0; i < std::min<std::size_t>(16, seeds.position.size()); i++)
    start.push_back({walls.local(seeds.position[i]), seeds.cell[i] >= 0, i});
  Timeline some;
  some.end = {std::min(1.0, plan.timeline.end.back())}, some.shape.assign(plan.timeline.shapes, 1.0);
  some.shapes = plan.timeline.shapes, some.record = {0};
  Tally tally;
  const auto begin = std::chrono::steady_clock::now();
  walk(walls, some, plan.physics, start.data(), start.size(), plan.seed, tally);
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return static_cast<double>(tally.steps) / std::max(1e-6, s);
}

void preflight(conceg_ctx *ctx, const Plan &plan, const Tissue &tissue, const Walls &walls,
               const Seeds &seeds, const Protocol &protocol) {
  const glm::dvec3 s = side(plan.box);
  const double inner = (s.x - 2.0 * plan.wanted.margin_um) * (s.y - 2.0 * plan.wanted.margin_um) *
                       (s.z - 2.0 * plan.wanted.margin_um);
  const double outside = static_cast<double>(std::count(seeds.cell.begin(), seeds.cell.end(), -1)),
               tried = static_cast<double>(seeds.tried);
  const double cells = (static_cast<double>(plan.walkers) - outside) / tried;
  const double step = step_length(plan.physics.intra, plan.physics.step_ms);
  const double steps =
      std::ceil(plan.timeline.end.back() / plan.physics.step_ms) * static_cast<double>(plan.walkers);
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "preflight: um, ms, um2/ms; box %g x %g x %g um, %s; %zu faces, %zu with images, %.0f MiB", s.x, s.y,
      s.z,
      plan.box.periodic[0] && plan.box.periodic[1] && plan.box.periodic[2] ? "periodic"
                                                                           : "not periodic on every axis",
      tissue.membranes.face.size(), walls.images(), static_cast<double>(walls.bytes()) / 1048576.0);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "preflight: %llu walkers seeded at %llu points of %.4g um3: %.4f in cells (+- %.4f), %.4f "
                 "between; the surfaces "
                 "hold %.4f of the box",
                 whole(plan.walkers), whole(seeds.tried), inner, cells,
                 std::sqrt(cells * (1.0 - cells) / tried), outside / tried,
                 tissue.cell_volume / volume(plan.box));
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "preflight: steps of %.4f um and %g ms; thinnest process %.3f um in radius, %.2f steps",
                 step, plan.physics.step_ms, tissue.thinnest_um, tissue.thinnest_um / step);
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "preflight: %zu measurements of %zu gradient shapes; standard error at most %.2g (one direction)",
      protocol.measurements(), plan.timeline.shapes, std::sqrt(0.5 / static_cast<double>(plan.walkers)));
  const double rate = try_rate(plan, walls, seeds);
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "preflight: %.3g steps, at %.3g a second and thread about %.0f s on %u threads", steps, rate,
                 steps / rate / conceg_ctx_threads(ctx), conceg_ctx_threads(ctx));
}

void put_protocol(conceg_doc *doc, const Protocol &p) {
  put(doc, "/protocol/b", p.b), put3(doc, "/protocol/direction", p.direction);
  put(doc, "/protocol/pulse_duration", p.pulse_duration),
      put(doc, "/protocol/pulse_separation", p.pulse_separation);
  put(doc, "/protocol/echo_time", p.echo_time);
  put_table(doc, "/protocol/b_tensor", p.b_tensor.front().data(), {p.measurements(), 6});
  put(doc, "/protocol/shell", shells(p));
  put(doc, "/protocol/interval_end", p.timeline.end);
  put_table(doc, "/protocol/shape", p.timeline.shape.data(), {p.timeline.shapes, p.timeline.intervals()});
  put_table(doc, "/protocol/coefficient", p.coefficient.empty() ? nullptr : &p.coefficient[0].x,
            {p.measurements(), p.timeline.shapes, 3});
}

void put_walkers(conceg_doc *doc, const Plan &plan, const Seeds &seeds, const std::vector<std::uint8_t> &code,
                 const Walked &walked, const Tally &tally, const Lost &lost,
                 const std::vector<double> &times) {
  put_scalar(doc, "/walkers@leaks", lost.leaks), put_scalar(doc, "/walkers@retractions", tally.retractions);
  put_scalar(doc, "/walkers@steps", tally.steps);
  put3(doc, "/walkers/position", seeds.position), put(doc, "/walkers/cell", seeds.cell),
      put(doc, "/walkers/compartment", code);
  const Walkers &w = walked.walkers;
  put_table(doc, "/walkers/vector", w.vector.empty() ? nullptr : &w.vector[0].x,
            {plan.walkers, plan.timeline.shapes, 3});
  if (!w.weight.empty()) put(doc, "/walkers/weight", w.weight);
  if (times.empty()) return;
  put(doc, "/walkers/time", times);
  put_table(doc, "/walkers/displacement", &w.displacement[0].x, {times.size(), plan.walkers, 3});
}

void put_signals(conceg_doc *doc, const Results &r, const Protocol &p, std::uint64_t tried) {
  const std::size_t rows = r.compartment.size();
  std::vector<std::string> names;
  std::vector<std::uint64_t> walkers;
  std::vector<double> fraction, signal, error, imaginary, powder, powder_error;
  for (std::size_t c = 0; c < rows; c++) {
    names.push_back(r.compartment[c].name), walkers.push_back(r.compartment[c].walker.size());
    fraction.push_back(static_cast<double>(walkers.back()) / static_cast<double>(tried));
    for (const Mean &m : r.signals[c].real)
      signal.push_back(m.value), error.push_back(m.error);
    imaginary.insert(imaginary.end(), r.signals[c].imaginary.begin(), r.signals[c].imaginary.end());
    for (const Mean &m : r.signals[c].powder)
      powder.push_back(m.value), powder_error.push_back(m.error);
  }
  put_texts(doc, "/signals/compartment", names), put(doc, "/signals/walkers", walkers),
      put(doc, "/signals/volume_fraction", fraction);
  put_table(doc, "/signals/signal", signal.data(), {rows, p.measurements()});
  put_table(doc, "/signals/standard_error", error.data(), {rows, p.measurements()});
  put_table(doc, "/signals/imaginary", imaginary.data(), {rows, p.measurements()});
  const std::vector<std::uint32_t> shell = shells(p);
  std::vector<double> powder_b(r.signals[0].powder.size());
  for (std::size_t m = p.measurements(); m-- > 0;)
    powder_b[shell[m]] = p.b[m];
  put(doc, "/signals/powder_b", powder_b);
  put_table(doc, "/signals/powder", powder.data(), {rows, powder_b.size()});
  put_table(doc, "/signals/powder_error", powder_error.data(), {rows, powder_b.size()});
  if (r.time.empty()) return;
  std::vector<double> msd, msd_error, d, d_error, k, k_error;
  for (const auto &row : r.spread)
    for (const Spread &s : row) {
      msd.push_back(s.msd.value), msd_error.push_back(s.msd.error);
      for (int axis = 0; axis < 3; axis++) {
        d.push_back(s.diffusivity[axis].value), d_error.push_back(s.diffusivity[axis].error);
        k.push_back(s.kurtosis[axis].value), k_error.push_back(s.kurtosis[axis].error);
      }
    }
  const std::size_t times = r.time.size();
  put(doc, "/signals/time", r.time);
  put_table(doc, "/signals/msd", msd.data(), {rows, times}),
      put_table(doc, "/signals/msd_error", msd_error.data(), {rows, times});
  put_table(doc, "/signals/diffusivity", d.data(), {rows, times, 3}),
      put_table(doc, "/signals/diffusivity_error", d_error.data(), {rows, times, 3});
  put_table(doc, "/signals/kurtosis", k.data(), {rows, times, 3}),
      put_table(doc, "/signals/kurtosis_error", k_error.data(), {rows, times, 3});
}

void log_results(conceg_ctx *ctx, const Results &r, const Protocol &p) {
  const std::vector<std::uint32_t> shell = shells(p);
  for (std::size_t c = 0; c < r.compartment.size(); c++) {
    std::string row;
    for (std::size_t i = 0; i < r.signals[c].powder.size() && i < 32; i++) {
      const std::size_t m =
          static_cast<std::size_t>(std::find(shell.begin(), shell.end(), i) - shell.begin());
      char text[64];
      std::snprintf(text, sizeof text, "  %.3g: %.5f(%.0e)", p.b[m], r.signals[c].powder[i].value,
                    r.signals[c].powder[i].error);
      row += text;
    }
    conceg_ctx_log(ctx, CONCEG_LOG_INFO, "%s, %zu walkers, mean over directions by b:%s",
                   r.compartment[c].name.c_str(), r.compartment[c].walker.size(), row.c_str());
  }
}

void write_files(const conceg_params *params, const Protocol &protocol, const Results &results) {
  const std::string csv = conceg_params_text(params, "csv"), nifti = conceg_params_text(params, "nifti"),
                    pictures = conceg_params_text(params, "pictures");
  if (!csv.empty()) write_csv(csv, protocol, results);
  if (!nifti.empty()) write_nifti(nifti, protocol, results);
  if (!pictures.empty()) write_figure(pictures, protocol, results);
}

void simulate_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  Phases phases;
  Protocol protocol = make_protocol(params);
  const std::vector<double> times = displacement_times(conceg_params_text(params, "times_ms"));
  if (!times.empty()) record_at(protocol.timeline, times);
  const Tissue tissue(ctx, doc);
  phases.end("tissue");
  Plan plan;
  plan.box = tissue.box, plan.wanted = make_wanted(params, tissue), plan.timeline = protocol.timeline;
  plan.physics = make_physics(ctx, params, tissue, protocol);
  plan.walkers = static_cast<std::uint64_t>(conceg_params_i64(params, "walkers")),
  plan.seed = conceg_ctx_seed(ctx);
  Workers workers(conceg_ctx_threads(ctx));
  const Progress progress = progress_of(ctx);
  const double reach = 1.01 * std::max(step_length(plan.physics.intra, plan.physics.step_ms),
                                       step_length(plan.physics.extra, plan.physics.step_ms));
  const Walls walls(plan.box, tissue.membranes, reach, workers, progress);
  phases.end("walls");
  const Seeds seeds =
      seed_walkers(plan.box, plan.wanted, plan.walkers, plan.seed, tissue.locate(), workers, progress);
  preflight(ctx, plan, tissue, walls, seeds, protocol);
  phases.end("seeds");
  put_protocol(doc, protocol);

  Walked walked;
  Keep keep;
  const std::string checkpoint = conceg_params_text(params, "checkpoint");
  const Checkpoint kept(ctx, doc, params, checkpoint);
  if (!checkpoint.empty()) {
    if (kept.read(walked))
      conceg_ctx_log(
          ctx, CONCEG_LOG_INFO, "%s: going on with %zu of %zu blocks of walkers done", checkpoint.c_str(),
          static_cast<std::size_t>(std::count(walked.done.begin(), walked.done.end(), std::uint8_t{1})),
          walked.done.size());
    keep = [&kept](const Walked &w) { kept.write(w); };
  }
  walk_all(plan, walls, seeds, walked, workers, progress, keep);
  phases.end("walk");
  const Lost lost = find_leaks(plan, walls, seeds, tissue.locate(), walked, workers, progress);

  const std::vector<std::uint8_t> code = codes(tissue, walls, seeds, workers);
  Results results;
  results.compartment = compartments(tissue, seeds, code), results.time = times;
  for (const Compartment &c : results.compartment) {
    results.signals.push_back(mean_signals(protocol, walked.walkers, c, workers));
    results.spread.emplace_back();
    for (std::size_t t = 0; t < results.time.size(); t++)
      results.spread.back().push_back(
          spread_of(&walked.walkers.displacement[t * walked.walkers.count], c.walker, results.time[t]));
  }
  workers.count(ctx, "simulate.items");
  phases.end("signals");
  Tally t;
  for (const Tally &block : walked.tally)
    t.add(block);
  put_walkers(doc, plan, seeds, code, walked, t, lost, results.time);
  put_signals(doc, results, protocol, seeds.tried);
  write_files(params, protocol, results);
  log_results(ctx, results, protocol);
  phases.end("output");
  tell_phases(ctx, "simulate", phases, workers.busy_s(), conceg_ctx_threads(ctx));
  conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                 "%.4g steps in %.4g moves, %.4g of them jumps, %.4g held against membranes; %.4g "
                 "reflections, %llu passages, %llu moves taken back",
                 static_cast<double>(t.steps), static_cast<double>(t.moves), static_cast<double>(t.jumps),
                 static_cast<double>(t.casts), static_cast<double>(t.reflections), whole(t.passages),
                 whole(t.retractions));
  if (static_cast<double>(t.retractions) > 1e-7 * static_cast<double>(t.steps) || lost.leaks > 0)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "simulate: %llu walkers leaked and walked again (%llu times), %llu moves of %llu steps "
                   "were taken back",
                   whole(lost.leaks), whole(lost.reruns), whole(t.retractions), whole(t.steps));
  conceg_ctx_log(ctx, CONCEG_LOG_RESULT, "leaks: %llu", whole(lost.leaks));
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "simulate", [&] { simulate_document(ctx, doc, params); });
}

const conceg_param parameters[] = {
    {"walkers", "1", "number of walkers", "10000", nullptr, CONCEG_PARAM_I64, 0, 1, 4e9},
    {"compartment", "", "where walkers begin, uniform by volume", "all", "intra|extra|all",
     CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"cells", "", "cells in which walkers begin: all, a row such as 7 or an id such as id:7", "all", nullptr,
     CONCEG_PARAM_TEXT, 0, 0, 0},
    {"kind", "", "type or class of cells in which walkers begin; empty = any", "", nullptr, CONCEG_PARAM_TEXT,
     0, 0, 0},
    {"margin_um", "um", "walkers begin at least so far inside the box", "0", nullptr, CONCEG_PARAM_F64, 0, 0,
     1e6},
    {"protocol", "",
     "scheme file (Camino STEJSKALTANNER or GRADIENT_WAVEFORM) or FSL bval file; empty = pairs of pulses by "
     "b and directions",
     "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"b", "ms/um2", "b-values, with commas", "0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15", nullptr,
     CONCEG_PARAM_TEXT, 0, 0, 0},
    {"directions", "1", "directions of each b-value", "40", nullptr, CONCEG_PARAM_I64, 0, 1, 1000},
    {"delta_ms", "ms", "duration of a pulse", "5", nullptr, CONCEG_PARAM_F64, 0, 1e-3, 1000},
    {"separation_ms", "ms", "from the start of the first pulse to that of the second", "20", nullptr,
     CONCEG_PARAM_F64, 0, 1e-3, 1000},
    {"echo_ms", "ms", "echo time; 0 = the end of the second pulse", "0", nullptr, CONCEG_PARAM_F64, 0, 0,
     10000},
    {"diffusivity_intra", "um2/ms", "diffusivity in cells", "2", nullptr, CONCEG_PARAM_F64, 0, 1e-3, 100},
    {"diffusivity_extra", "um2/ms", "diffusivity between cells", "2", nullptr, CONCEG_PARAM_F64, 0, 1e-3,
     100},
    {"t2_intra_ms", "ms", "T2 in cells; 0 = no relaxation", "0", nullptr, CONCEG_PARAM_F64, 0, 0, 1e6},
    {"t2_extra_ms", "ms", "T2 between cells; 0 = no relaxation", "0", nullptr, CONCEG_PARAM_F64, 0, 0, 1e6},
    {"permeability", "um/ms",
     "of membranes: one value, or name=value of compartments with commas (soma=0.02,axon=0)", "0", nullptr,
     CONCEG_PARAM_TEXT, 0, 0, 0},
    {"step_ms", "ms", "longest time step", "0.001", nullptr, CONCEG_PARAM_F64, 0, 1e-6, 1},
    {"times_ms", "ms",
     "times of displacements: with commas, or FIRST:LAST:COUNT evenly by their logarithm; empty = none", "",
     nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"method", "",
     "jumps: far from membranes many steps at once; steps: every step by itself, each held against membranes",
     "jumps", "jumps|steps", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"csv", "", "folder for signals.csv, powder.csv, displacements.csv", "", nullptr, CONCEG_PARAM_FILE, 0, 0,
     0},
    {"nifti", "", "folder for signals.nii with bval and bvec", "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"pictures", "", "folder for signals.svg", "", nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {"checkpoint", "", "file that keeps finished walkers; a run that finds it goes on from there", "",
     nullptr, CONCEG_PARAM_FILE, 0, 0, 0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};
const char *const reads[] = {"domain", "types", "cells", "meshes", nullptr};
const char *const writes[] = {"walkers", "protocol", "signals", nullptr};
const char *const drops[] = {nullptr};

} // namespace

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_simulate;
const conceg_stage conceg_stage_simulate = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "simulate",
    "walkers",
    "1.0.0",
    "walkers between the membranes, and the diffusion MRI signals that they give",
    "conceg simulate cube.cgx --walkers 100000 --csv signals -o simulated.cgx",
    parameters,
    reads,
    writes,
    drops,
    CONCEG_STAGE_THREADED,
    nullptr,
    run,
};
