// SPDX-License-Identifier: BSD-3-Clause
// fit: /signals and /protocol -> SANDI's figures, with the geometry's beside them (README.md).
#include "conceg/stage.h"

#include "geometry.hpp"
#include "kernels.hpp"
#include "output.hpp"
#include "pictures.hpp"
#include "read.hpp"
#include "results.hpp"
#include "words.hpp"

#include <algorithm>
#include <map>

namespace conceg::fit {
namespace {

// Below this, spheres of the largest radii need larger matrices than the exact kernel has.
constexpr double lowest_soma_diffusivity = 0.5;

struct Options {
  std::string compartment, model, csv, pictures;
  Model free; // kernel, extracellular term and bounds that the parameters ask for
  double neurite_diffusivity = 2.0;
  bool variants = false;
  double shell_width = 0.05;
  std::size_t starts = 24;
};

void hold(Model &model, Parameter parameter, double value) {
  model.lower[parameter] = model.upper[parameter] = value;
}

void read_bounds(const conceg_params *params, Model &model) {
  const auto value = [&](const char *name) { return conceg_params_f64(params, name); };
  const double low = value("diffusivity_min"), high = value("diffusivity_max");
  if (!(low < high))
    fail(CONCEG_E_PARAM, "diffusivity_min: expected less than diffusivity_max (%g), got %g", high, low);
  model.lower[soma_radius] = value("radius_min_um"), model.upper[soma_radius] = value("radius_max_um");
  if (!(model.lower[soma_radius] < model.upper[soma_radius]))
    fail(CONCEG_E_PARAM, "radius_min_um: expected less than radius_max_um (%g), got %g",
         model.upper[soma_radius], model.lower[soma_radius]);
  hold(model, neurite_d, value("neurite_diffusivity")), hold(model, extra_d, value("extra_diffusivity"));
  hold(model, soma_d, value("soma_diffusivity"));
  for (const std::string &word : split(conceg_params_text(params, "free"))) {
    const char *const names[] = {"neurite", "extra", "soma", "none"};
    const Parameter which[] = {neurite_d, extra_d, soma_d};
    const auto found = std::find(std::begin(names), std::end(names), word) - std::begin(names);
    if (found == 4)
      fail(CONCEG_E_PARAM, "free: expected some of neurite, extra, soma, or none, got %s", word.c_str());
    if (found == 3) continue;
    model.lower[which[found]] = found == 2 ? std::max(low, lowest_soma_diffusivity) : low;
    model.upper[which[found]] = high;
    if (!(model.lower[which[found]] < high))
      fail(CONCEG_E_PARAM, "diffusivity_max: expected more than %g where the soma's is free, got %g",
           lowest_soma_diffusivity, high);
  }
}

Options read_options(const conceg_params *params) {
  Options o;
  o.compartment = conceg_params_text(params, "compartment"), o.model = conceg_params_text(params, "model");
  o.csv = conceg_params_text(params, "csv"), o.pictures = conceg_params_text(params, "pictures");
  o.free.kernel = std::string(conceg_params_text(params, "kernel")) == "exact" ? Kernel::exact : Kernel::gpd;
  o.free.extracellular = std::string(conceg_params_text(params, "extracellular")) == "sheet"
                             ? Extracellular::sheet
                             : Extracellular::ball;
  o.neurite_diffusivity = conceg_params_f64(params, "neurite_diffusivity");
  o.variants = conceg_params_bool(params, "variants") != 0;
  o.shell_width = conceg_params_f64(params, "shell_width");
  o.starts = static_cast<std::size_t>(conceg_params_i64(params, "starts"));
  o.free.weighted = std::string(conceg_params_text(params, "weights")) == "errors";
  read_bounds(params, o.free);
  check_pictures(o.pictures);
  return o;
}

// The models to fit to a signal: one, or with `variants` both kernels with the neurites' diffusivity free and
// held.
std::vector<Model> models_of(const Options &options, bool reduced, double diffusivity_min,
                             double diffusivity_max) {
  Model model = options.free;
  if (reduced) {
    model.extracellular = Extracellular::none;
    hold(model, extra_share, 0.0), model.upper[extra_d] = model.lower[extra_d];
  }
  if (!options.variants) return {model};
  std::vector<Model> out;
  for (const Kernel kernel : {Kernel::gpd, Kernel::exact})
    for (const bool held : {false, true}) {
      model.kernel = kernel;
      model.lower[neurite_d] = diffusivity_min, model.upper[neurite_d] = diffusivity_max;
      if (held) hold(model, neurite_d, options.neurite_diffusivity);
      out.push_back(model);
    }
  return out;
}

std::vector<std::string> names_of_fitted(const Model &model) {
  std::vector<std::string> out;
  for (std::size_t p = 0; p < parameters; p++)
    if (model.lower[p] < model.upper[p]) out.push_back(parameter_names[p]);
  return out;
}

bool is_reduced(const Options &options, const std::string &compartment) {
  return options.model == "auto" ? compartment != "all" : options.model == "reduced";
}

// Exact spheres of one timing serve all signals.
class Spheres {
public:
  Spheres(Workers &workers, Progress progress) : workers_(workers), progress_(std::move(progress)) {}
  const Sphere &of(const Model &model, const Timing &timing, double most_b) {
    const Key key{int(model.kernel), timing.delta_ms, timing.separation_ms, most_b};
    const auto found = made_.find(key);
    if (found != made_.end()) return found->second;
    return made_.emplace(key, make_sphere(model, timing, most_b, workers_, progress_)).first->second;
  }

private:
  using Key = std::tuple<int, double, double, double>;
  Workers &workers_;
  Progress progress_;
  std::map<Key, Sphere> made_;
};

void fit_document(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  const Options options = read_options(params);
  const double low = conceg_params_f64(params, "diffusivity_min"),
               high = conceg_params_f64(params, "diffusivity_max");
  const std::vector<Signal> signals = read_signals(ctx, doc, options.compartment);
  Workers workers(conceg_ctx_threads(ctx));
  Spheres spheres(workers, progress_of(ctx));
  std::vector<Result> results;
  for (const Signal &signal : signals) {
    const Averages averages = average_shells(signal.rows, options.shell_width, signal.name);
    for (const std::string &warning : averages.warnings)
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING, "fit: %s", warning.c_str());
    const bool reduced = is_reduced(options, signal.compartment);
    for (const Model &model : models_of(options, reduced, low, high)) {
      check_shells(averages.shells, names_of_fitted(model), signal.name);
      if (model.weighted) check_errors(averages.shells, signal.name);
      const Sphere &sphere = spheres.of(model, signal.timing, averages.shells.b.back());
      Result result{signal.name, signal.timing, model, averages, {}, reduced};
      const Progress progress = progress_of(ctx);
      result.fit = fit_sandi(model, sphere, averages.shells, options.starts);
      results.push_back(std::move(result));
      report(progress, "fitting", results.size(), signals.size() * (options.variants ? 4 : 1));
    }
  }
  const Truth truth = read_truth(ctx, doc, workers);
  if (!options.csv.empty()) make_folder(options.csv);
  for (const Table &table : tables(results, truth)) {
    must(conceg_doc_drop(doc, ("/statistics/" + table.name).c_str()));
    if (!table.rows()) continue;
    write_table(doc, table);
    if (options.csv.empty()) continue;
    OutputFile file(options.csv + "/" + table.name + ".csv");
    file.write(table.csv()), file.commit();
  }
  draw_pictures(options.pictures, results);
  for (const std::string &line : lines(results, truth))
    conceg_ctx_log(ctx, CONCEG_LOG_RESULT, "%s", line.c_str());
  workers.count(ctx, "fit.items");
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params) {
  return guard(ctx, "fit", [&] { fit_document(ctx, doc, params); });
}

const conceg_param table[] = {
    {"compartment", "", "signals to fit, by /signals/compartment, separated by commas; empty = intra and all",
     "", nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"model", "",
     "with an extracellular term (full) or without (reduced); auto = full for the signal named all", "auto",
     "auto|reduced|full", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"kernel", "", "sphere by the Gaussian phase distribution, as SANDI was published, or exact", "gpd",
     "gpd|exact", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"extracellular", "", "Gaussian in all directions (ball, as published) or along planes alone (sheet)",
     "ball", "ball|sheet", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"free", "", "diffusivities that are fitted, separated by commas: neurite, extra, soma; or none",
     "neurite,extra", nullptr, CONCEG_PARAM_TEXT, 0, 0, 0},
    {"neurite_diffusivity", "um^2/ms", "of neurites, where it is held", "2", nullptr, CONCEG_PARAM_F64, 0,
     0.01, 10},
    {"extra_diffusivity", "um^2/ms", "of the extracellular space, where it is held", "1", nullptr,
     CONCEG_PARAM_F64, 0, 0.01, 10},
    {"soma_diffusivity", "um^2/ms", "of somas, where it is held", "3", nullptr, CONCEG_PARAM_F64, 0, 0.01,
     10},
    {"diffusivity_min", "um^2/ms", "lowest fitted diffusivity (of somas at least 0.5)", "0.1", nullptr,
     CONCEG_PARAM_F64, 0, 0.01, 10},
    {"diffusivity_max", "um^2/ms", "highest fitted diffusivity", "3", nullptr, CONCEG_PARAM_F64, 0, 0.02, 10},
    {"radius_min_um", "um", "lowest fitted soma radius", "1", nullptr, CONCEG_PARAM_F64, 0, 0.1, 50},
    {"radius_max_um", "um", "highest fitted soma radius", "15", nullptr, CONCEG_PARAM_F64, 0, 0.2, 50},
    {"variants", "", "fit both kernels, each with the neurites' diffusivity free and held", "false", nullptr,
     CONCEG_PARAM_BOOL, 0, 0, 0},
    {"starts", "1", "points within the bounds to fit from", "24", nullptr, CONCEG_PARAM_I64, 0, 1, 10000},
    {"weights", "",
     "of the residuals: none, as published, or errors = 1 / standard error of each direction average", "none",
     "none|errors", CONCEG_PARAM_CHOICE, 0, 0, 0},
    {"shell_width", "ms/um^2", "values of b this near to each other are averaged; b up to this is b = 0",
     "0.05", nullptr, CONCEG_PARAM_F64, 0, 0, 10},
    {"csv", "", "folder for the tables as comma-separated files; made when absent", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {"pictures", "", "folder for a figure of every signal as an SVG file; made when absent", "", nullptr,
     CONCEG_PARAM_FILE, 0, 0, 0},
    {nullptr, nullptr, nullptr, nullptr, nullptr, 0, 0, 0, 0}};
const char *const reads[] = {"signals", "protocol", nullptr};
const char *const writes[] = {"statistics", nullptr};
const char *const drops[] = {nullptr};

} // namespace
} // namespace conceg::fit

extern "C" CONCEG_EXPORT const conceg_stage conceg_stage_fit;
extern "C" const conceg_stage conceg_stage_fit = {
    CONCEG_STAGE_ABI,
    sizeof(conceg_stage),
    "fit",
    "sandi",
    "1.0.0",
    "fits SANDI (neurites, somas, extracellular space) to diffusion signals and puts the geometry's figures "
    "beside",
    "conceg fit < simulated.cgx > fitted.cgx",
    conceg::fit::table,
    conceg::fit::reads,
    conceg::fit::writes,
    conceg::fit::drops,
    CONCEG_STAGE_THREADED,
    nullptr,
    conceg::fit::run,
};
