// SPDX-License-Identifier: BSD-3-Clause
#include "results.hpp"

#include <algorithm>
#include <cstdio>

namespace conceg::fit {
namespace {

constexpr const char *fraction_names[] = {"f_neurite", "f_soma", "f_extracellular"};

// Fractions that the fit should find: of the cells for the reduced model, of the box for the full one.
bool true_fractions(const Result &result, const Truth &truth, std::array<double, 3> &out) {
  if (!truth.known || (!result.intracellular && !truth.box)) return false;
  if (result.intracellular)
    out = {1.0 - truth.soma_share, truth.soma_share, 0.0};
  else
    out = {truth.neurite, truth.soma, truth.extracellular};
  return true;
}

Table fit_table(const std::vector<Result> &results, const Truth &truth) {
  Table t("sandi");
  // Columns of tables are numbers throughout, so the truth's are there only when each row has one.
  std::array<double, 3> truths{};
  const bool all_known = std::all_of(results.begin(), results.end(),
                                     [&](const Result &r) { return true_fractions(r, truth, truths); });
  for (const Result &r : results) {
    t.put("signal", r.signal), t.put("model", model_name(r)), t.put("kernel", kernel_name(r));
    t.put("extracellular", r.model.extracellular == Extracellular::none   ? "none"
                           : r.model.extracellular == Extracellular::ball ? "ball"
                                                                          : "sheet");
    t.put("pulse_duration", r.timing.delta_ms, "ms"), t.put("pulse_separation", r.timing.separation_ms, "ms");
    if (all_known) true_fractions(r, truth, truths);
    for (std::size_t k = 0; k < 3; k++) {
      const std::string name = fraction_names[k];
      t.put(name.c_str(), r.fit.fraction[k], "1");
      t.put((name + "_error").c_str(), r.fit.fraction_error[k], "1");
      if (all_known) t.put((name + "_truth").c_str(), truths[k], "1");
    }
    for (std::size_t p = soma_radius; p < parameters; p++) {
      t.put(parameter_names[p], r.fit.values[p], parameter_units[p]);
      t.put((std::string(parameter_names[p]) + "_error").c_str(), r.fit.error[p], parameter_units[p]);
    }
    if (truth.known)
      t.put("radius_truth", truth.sphere.mean, "um"),
          t.put("radius_truth_effective", truth.sphere.effective, "um");
    t.put("rms", r.fit.rms, "1"), t.put("rival_rms", r.fit.rival_rms, "1");
    t.put("shells", static_cast<std::uint64_t>(r.averages.shells.b.size()));
    t.put("starts", static_cast<std::uint64_t>(r.fit.starts));
    t.put("arrived", static_cast<std::uint64_t>(r.fit.arrived));
    t.put("converged", std::uint64_t{r.fit.converged});
    t.put("fitted", listed(r.fit.fitted)), t.put("at_bound", listed(r.fit.at_bound));
    t.put("errors_from", r.fit.singular ? "none" : r.averages.shells.error.empty() ? "residuals" : "signal");
    t.put("exchanged", std::uint64_t{r.fit.exchanged});
  }
  return t;
}

Table shell_table(const std::vector<Result> &results) {
  Table t("sandi_shell");
  for (std::size_t row = 0; row < results.size(); row++) {
    const Shells &s = results[row].averages.shells;
    for (std::size_t i = 0; i < s.b.size(); i++) {
      t.put("fit", static_cast<std::uint64_t>(row)), t.put("b", s.b[i], "ms/um^2");
      t.put("directions", results[row].averages.members[i]);
      t.put("signal", s.signal[i], "1"), t.put("error", s.error.empty() ? 0.0 : s.error[i], "1");
      t.put("fitted", results[row].fit.predicted[i], "1");
      t.put("residual", s.signal[i] - results[row].fit.predicted[i], "1");
    }
  }
  return t;
}

Table covariance_table(const std::vector<Result> &results) {
  Table t("sandi_covariance");
  for (std::size_t row = 0; row < results.size(); row++) {
    const SandiFit &fit = results[row].fit;
    for (std::size_t a = 0; a < parameters && !fit.singular; a++)
      for (std::size_t b = 0; b < parameters; b++)
        if (fit.fitted[a] && fit.fitted[b]) {
          t.put("fit", static_cast<std::uint64_t>(row));
          t.put("row", parameter_names[a]), t.put("column", parameter_names[b]);
          t.put("covariance", fit.covariance[a * parameters + b], "1");
        }
  }
  return t;
}

Table truth_table(const Truth &truth) {
  Table t("sandi_truth");
  const auto row = [&](const char *name, double value, const char *unit) {
    t.put("name", name), t.put("value", value, "1"), t.put("value_unit", unit);
  };
  if (!truth.known) return t;
  row("soma_share_of_cells", truth.soma_share, "1");
  if (truth.box) {
    row("f_neurite", truth.neurite, "1"), row("f_soma", truth.soma, "1");
    row("f_extracellular", truth.extracellular, "1");
  }
  row("somas", static_cast<double>(truth.somas), "1");
  row("radius_mean", truth.sphere.mean, "um"),
      row("radius_volume_weighted", truth.sphere.volume_weighted, "um");
  row("radius_effective", truth.sphere.effective, "um");
  row("mesh_radius_mean", truth.mesh.mean, "um");
  row("mesh_radius_volume_weighted", truth.mesh.volume_weighted, "um");
  row("mesh_radius_effective", truth.mesh.effective, "um");
  return t;
}

template <class... Values> std::string text(const char *format, Values... values) {
  char line[400];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string fraction_words(const Result &r, const Truth &truth) {
  std::array<double, 3> truths{};
  const bool known = true_fractions(r, truth, truths);
  std::string out;
  for (std::size_t k = 0; k < 3; k++) {
    if (k == 2 && r.intracellular) continue;
    out += text("%s%s %.3f +- %.2g", k ? ", " : "", fraction_names[k], r.fit.fraction[k],
                r.fit.fraction_error[k]);
    if (known) out += text(" (truth %.3f)", truths[k]);
  }
  return out;
}

std::string value_words(const Result &r, const Truth &truth) {
  const auto one = [&](Parameter p, const char *name) {
    return r.fit.fitted[p] ? text("%s %.3f +- %.2g", name, r.fit.values[p], r.fit.error[p])
                           : text("%s %g held", name, r.fit.values[p]);
  };
  std::string out = text("radius %.2f +- %.2g um", r.fit.values[soma_radius], r.fit.error[soma_radius]);
  if (truth.known)
    out += text(" (truth %.2f mean, %.2f volume-weighted, %.2f effective)", truth.sphere.mean,
                truth.sphere.volume_weighted, truth.sphere.effective);
  out += "; diffusivities " + one(neurite_d, "neurite") + ", " + one(soma_d, "soma");
  if (!r.intracellular) out += ", " + one(extra_d, "extracellular");
  return out + " um^2/ms";
}

std::string quality_words(const Result &r) {
  std::string out = text("rms %.2e over %zu shells; %zu of %zu starts ended here", r.fit.rms,
                         r.averages.shells.b.size(), r.fit.arrived, r.fit.starts);
  if (r.fit.rival_rms > 0.0) out += text(", the next minimum has rms %.2e", r.fit.rival_rms);
  const std::string bounds = listed(r.fit.at_bound);
  if (!bounds.empty()) out += "; AT A BOUND: " + bounds;
  if (r.fit.singular) out += "; no errors: the data cannot tell the parameters apart";
  if (!r.fit.converged) out += "; NOT CONVERGED";
  if (r.fit.exchanged) out += "; sphere and ball exchanged, so that the sphere decays more slowly";
  return out;
}

} // namespace

std::string model_name(const Result &result) {
  return result.model.extracellular == Extracellular::none ? "reduced" : "full";
}

std::string kernel_name(const Result &result) {
  return result.model.kernel == Kernel::gpd ? "gpd" : "exact";
}

std::string listed(const std::array<bool, parameters> &which) {
  std::string out;
  for (std::size_t p = 0; p < parameters; p++)
    if (which[p]) out += (out.empty() ? "" : " ") + std::string(parameter_names[p]);
  return out;
}

std::vector<Table> tables(const std::vector<Result> &results, const Truth &truth) {
  return {fit_table(results, truth), shell_table(results), covariance_table(results), truth_table(truth)};
}

std::vector<std::string> lines(const std::vector<Result> &results, const Truth &truth) {
  std::vector<std::string> out;
  for (const Result &r : results) {
    out.push_back(r.signal + ": " + model_name(r) + " SANDI, " + kernel_name(r) + " sphere" +
                  (r.model.extracellular == Extracellular::sheet ? ", extracellular sheet" : ""));
    out.push_back("  " + fraction_words(r, truth)), out.push_back("  " + value_words(r, truth));
    out.push_back("  " + quality_words(r));
  }
  return out;
}

} // namespace conceg::fit
