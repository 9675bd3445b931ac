// SPDX-License-Identifier: BSD-3-Clause
#include "diffusivity.hpp"

#include <map>

namespace conceg::analyse {

namespace {

constexpr double laws[] = {0.0, 0.5, 1.0};
constexpr int axes[] = {mean_axis, 0, 1, 2};
constexpr std::uint8_t soma_code = 1;

struct Group {
  std::string name;
  std::vector<std::uint32_t> walker;
};

std::vector<Group> groups_of(const Displacements &walked, const Cells &cells) {
  Group all = {"all", {}}, intra = {"intra", {}}, extra = {"extra", {}}, soma = {"soma", {}},
        neurite = {"neurite", {}};
  std::map<std::string, Group> classes;
  for (std::uint32_t w = 0; w < walked.cell.size(); w++) {
    all.walker.push_back(w);
    if (walked.cell[w] < 0) {
      extra.walker.push_back(w);
      continue;
    }
    intra.walker.push_back(w);
    if (!walked.compartment.empty())
      (walked.compartment[w] == soma_code ? soma : neurite).walker.push_back(w);
    const std::string &name = cells.type_class[cells.type[static_cast<std::size_t>(walked.cell[w])]];
    classes[name].name = "class " + name, classes[name].walker.push_back(w);
  }
  std::vector<Group> out;
  if (!intra.walker.empty() && !extra.walker.empty()) out.push_back(std::move(all));
  for (Group *group : {&intra, &extra, &soma, &neurite})
    if (!group->walker.empty()) out.push_back(std::move(*group));
  for (auto &[name, group] : classes)
    out.push_back(std::move(group));
  return out;
}

const Tail &tail_of(const Diffusivity &d, int axis, double asked) {
  for (const NamedTail &t : d.tails)
    if (t.axis == axis && t.asked == asked) return t.tail;
  fail(CONCEG_E_INTERNAL, "diffusivity: no such fit");
}

const char *axis_name(int axis) {
  return axis == mean_axis ? "mean" : axis == 0 ? "x" : axis == 1 ? "y" : "z";
}

} // namespace

std::vector<Diffusivity> diffusivities(const Displacements &walked, const Cells &cells,
                                       const TailRange &range, Workers &workers) {
  const std::vector<Group> groups = groups_of(walked, cells);
  std::vector<double> time;
  std::vector<const glm::dvec3 *> moved;
  for (std::size_t t = 0; t < walked.time.size(); t++)
    if (walked.time[t] >= range.from && walked.time[t] <= range.to)
      time.push_back(walked.time[t]), moved.push_back(walked.moved[t]);
  std::vector<Diffusivity> out(groups.size());
  const std::size_t times = walked.time.size(), tasks = times + std::size(axes);
  for (std::size_t g = 0; g < groups.size(); g++) {
    out[g].compartment = groups[g].name, out[g].walkers = groups[g].walker.size();
    out[g].spread.resize(times), out[g].tails.resize(std::size(axes) * std::size(laws));
  }
  workers.loop(groups.size() * tasks, 1, [&](std::size_t i, unsigned) {
    const Group &group = groups[i / tasks];
    Diffusivity &found = out[i / tasks];
    const std::size_t task = i % tasks;
    if (task < times) {
      found.spread[task] = spread_of(walked.moved[task], group.walker, walked.time[task]);
      return;
    }
    const std::size_t a = task - times;
    const DiffusivityCurve curve = diffusivity_curve(moved, time, group.walker, axes[a]);
    for (std::size_t law = 0; law < std::size(laws); law++)
      found.tails[a * std::size(laws) + law] = {axes[a], laws[law], fit_tail(curve, laws[law])};
  });
  return out;
}

WalkedLambda walked_lambda(const std::vector<Diffusivity> &all, const Displacements &walked) {
  WalkedLambda out;
  const auto is_void = [&](const char *why) {
    out.state = std::string("void: ") + why;
    return out;
  };
  if (walked.permeable) return is_void("walkers pass membranes");
  if (!(walked.free_extra > 0.0)) return is_void("/provenance does not say how fast walkers were");
  for (const Diffusivity &d : all) {
    if (d.compartment != "extra") continue;
    const Tail &mean = tail_of(d, mean_axis, 1.0);
    out.state = mean.state;
    if (mean.state.rfind("void", 0) == 0) return out;
    if (!(mean.limit.value > 3.0 * mean.limit.error)) return is_void("nothing goes through");
    for (int axis = 0; axis < 3; axis++) {
      const Mean &limit = tail_of(d, axis, 1.0).limit;
      out.ratio[axis] = {limit.value / walked.free_extra, limit.error / walked.free_extra};
    }
    out.lambda.value = std::sqrt(walked.free_extra / mean.limit.value);
    out.lambda.error = 0.5 * out.lambda.value * mean.limit.error / mean.limit.value;
    return out;
  }
  return is_void("no walker began between cells");
}

Table diffusivity_table(const std::vector<Diffusivity> &all, const std::vector<double> &time) {
  Table table("diffusivity");
  for (const Diffusivity &d : all)
    for (std::size_t t = 0; t < time.size(); t++) {
      const Spread &s = d.spread[t];
      table.put("compartment", d.compartment), table.put("walkers", d.walkers);
      table.put("time", time[t], "ms");
      table.put("diffusivity", s.msd.value / (6.0 * time[t]), "um^2/ms");
      table.put("diffusivity_error", s.msd.error / (6.0 * time[t]), "um^2/ms");
      table.put("kurtosis", s.mean_kurtosis.value, "1");
      table.put("kurtosis_error", s.mean_kurtosis.error, "1");
      for (int axis = 0; axis < 3; axis++) {
        const std::string name = axis_name(axis);
        table.put(("diffusivity_" + name).c_str(), s.diffusivity[axis].value, "um^2/ms");
        table.put(("diffusivity_" + name + "_error").c_str(), s.diffusivity[axis].error, "um^2/ms");
        table.put(("kurtosis_" + name).c_str(), s.kurtosis[axis].value, "1");
        table.put(("kurtosis_" + name + "_error").c_str(), s.kurtosis[axis].error, "1");
      }
    }
  return table;
}

Table diffusivity_fit_table(const std::vector<Diffusivity> &all, const TailRange &range) {
  Table table("diffusivity_fit");
  for (const Diffusivity &d : all)
    for (const NamedTail &named : d.tails) {
      const Tail &t = named.tail;
      table.put("compartment", d.compartment), table.put("axis", std::string(axis_name(named.axis)));
      table.put("law", std::string(named.asked > 0.0 ? named.asked < 1.0 ? "t^-1/2" : "t^-1" : "free"));
      table.put("state", t.state), table.put("walkers", d.walkers);
      table.put("from", range.from, "ms"), table.put("to", range.to, "ms");
      table.put("limit", t.limit.value, "um^2/ms"), table.put("limit_error", t.limit.error, "um^2/ms");
      table.put("amplitude", t.amplitude.value, "um^2/ms");
      table.put("amplitude_error", t.amplitude.error, "um^2/ms");
      table.put("exponent", t.exponent.value, "1"), table.put("exponent_error", t.exponent.error, "1");
      table.put("chi2", t.chi2, "1"), table.put("degrees", static_cast<std::uint64_t>(t.degrees));
    }
  return table;
}

Table lambda_table(const WalkedLambda &walked, const Transport *solved, const Transport *finest) {
  Table table("lambda");
  const auto put = [&](const char *name, const std::string &state, const Mean *ratio, const Mean &lambda) {
    table.put("name", std::string(name)), table.put("state", state);
    table.put("lambda", lambda.value, "1"), table.put("lambda_error", lambda.error, "1");
    for (int axis = 0; axis < 3; axis++) {
      const std::string column = std::string("ratio_") + axis_name(axis);
      table.put(column.c_str(), ratio[axis].value, "1");
      table.put((column + "_error").c_str(), ratio[axis].error, "1");
    }
  };
  put("lambda_walkers", walked.state, walked.ratio, walked.lambda);
  if (!solved) return table;
  Mean ratio[3];
  for (std::size_t axis = 0; axis < 3; axis++)
    ratio[axis] = {solved->ratio[axis], std::fabs(solved->ratio[axis] - finest->ratio[axis])};
  put("lambda_solver", "solved", ratio, {solved->lambda(), std::fabs(solved->lambda() - finest->lambda())});
  return table;
}

} // namespace conceg::analyse
