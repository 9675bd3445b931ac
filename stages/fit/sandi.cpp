// SPDX-License-Identifier: BSD-3-Clause
#include "sandi.hpp"

#include "gaussian.hpp"
#include "least_squares.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::fit {

const char *const parameter_names[parameters] = {
    "f_extracellular",     "soma_share",        "radius",
    "neurite_diffusivity", "extra_diffusivity", "soma_diffusivity"};
const char *const parameter_units[parameters] = {"1", "1", "um", "um^2/ms", "um^2/ms", "um^2/ms"};

double sandi_signal(const Model &model, const Sphere &sphere, double b, const double *v, double *slope) {
  const SphereSignal soma = sphere.signal(b, v[soma_radius], v[soma_d]);
  const Attenuation neurite = stick(b * v[neurite_d]);
  Attenuation extra{0.0, 0.0};
  if (model.extracellular == Extracellular::ball) extra = ball(b * v[extra_d]);
  if (model.extracellular == Extracellular::sheet) extra = sheet(b * v[extra_d]);
  const double f_e = v[extra_share], g = v[soma_share];
  const double inside = g * soma.value + (1.0 - g) * neurite.value;
  if (slope) {
    slope[extra_share] = extra.value - inside;
    slope[soma_share] = (1.0 - f_e) * (soma.value - neurite.value);
    slope[soma_radius] = (1.0 - f_e) * g * soma.by_radius;
    slope[soma_d] = (1.0 - f_e) * g * soma.by_diffusivity;
    slope[neurite_d] = (1.0 - f_e) * (1.0 - g) * neurite.slope * b;
    slope[extra_d] = f_e * extra.slope * b;
  }
  return f_e * extra.value + (1.0 - f_e) * inside;
}

namespace {

// 1 / error, scaled to a mean square of 1; ones without weights.
std::vector<double> weights(const Model &model, const Shells &shells) {
  std::vector<double> out(shells.b.size(), 1.0);
  if (!model.weighted) return out;
  double sum = 0.0;
  for (const double error : shells.error)
    sum += 1.0 / (error * error);
  const double scale = std::sqrt(static_cast<double>(out.size()) / sum);
  for (std::size_t i = 0; i < out.size(); i++)
    out[i] = scale / shells.error[i];
  return out;
}

LeastSquares make_problem(const Model &model, const Sphere &sphere, const Shells &shells) {
  LeastSquares problem;
  problem.residuals = shells.b.size();
  problem.lower.assign(model.lower.begin(), model.lower.end());
  problem.upper.assign(model.upper.begin(), model.upper.end());
  problem.evaluate = [&, weight = weights(model, shells)](const double *values, double *residuals,
                                                          double *jacobian) {
    for (std::size_t i = 0; i < shells.b.size(); i++) {
      double *const row = jacobian ? jacobian + i * parameters : nullptr;
      residuals[i] = weight[i] * (sandi_signal(model, sphere, shells.b[i], values, row) - shells.signal[i]);
      for (std::size_t p = 0; row && p < parameters; p++)
        row[p] *= weight[i];
    }
  };
  return problem;
}

// The n-th number of van der Corput's sequence: even cover of (0, 1), for Halton's points.
double halton(std::size_t n, unsigned base) {
  double out = 0.0, part = 1.0 / base;
  for (; n; n /= base, part /= base)
    out += static_cast<double>(n % base) * part;
  return out;
}

std::vector<double> start_point(const Model &model, std::size_t n) {
  constexpr unsigned base[parameters] = {2, 3, 5, 7, 11, 13};
  std::vector<double> out(parameters);
  for (std::size_t i = 0; i < parameters; i++)
    out[i] = model.lower[i] + (model.upper[i] - model.lower[i]) * halton(n + 1, base[i]);
  return out;
}

// Sphere and ball in each other's place, where the bounds allow it and the sphere is the one that decays
// faster.
bool exchanged_point(const Model &model, const Sphere &sphere, const std::vector<double> &from,
                     std::vector<double> &to) {
  if (!sphere.apparent || model.extracellular != Extracellular::ball) return false;
  const double adc = sphere.apparent(from[soma_radius], from[soma_d]);
  const double f_s = (1.0 - from[extra_share]) * from[soma_share];
  if (adc <= from[extra_d] || f_s >= 1.0) return false;
  to = from;
  to[soma_radius] = sphere.radius_of(from[extra_d], from[soma_d]), to[extra_d] = adc;
  to[extra_share] = f_s, to[soma_share] = std::min(1.0, from[extra_share] / (1.0 - f_s));
  for (std::size_t i = 0; i < parameters; i++)
    if (to[i] < model.lower[i] || to[i] > model.upper[i]) return false;
  return true;
}

// Largest difference, relative to the bounds.
double distance(const Model &model, const std::vector<double> &a, const std::vector<double> &b) {
  double most = 0.0;
  for (std::size_t i = 0; i < parameters; i++)
    if (model.upper[i] > model.lower[i])
      most = std::max(most, std::fabs(a[i] - b[i]) / (model.upper[i] - model.lower[i]));
  return most;
}

struct Ends {
  std::vector<Minimum> minima;
  std::vector<bool> exchanged;
  std::size_t best = 0;
};

Ends search(const Model &model, const Sphere &sphere, const LeastSquares &problem, std::size_t starts) {
  Ends ends;
  for (std::size_t n = 0; n < starts; n++) {
    Minimum end = minimise(problem, start_point(model, n));
    std::vector<double> other;
    bool exchanged = false;
    if (exchanged_point(model, sphere, end.parameters, other)) {
      const Minimum again = minimise(problem, other);
      if (again.cost <= end.cost * (1.0 + 1e-6) + 1e-16) end = again, exchanged = true;
    }
    ends.minima.push_back(end), ends.exchanged.push_back(exchanged);
    if (end.cost < ends.minima[ends.best].cost) ends.best = n;
  }
  return ends;
}

// Standard errors of the fractions from the covariance of f_e and g.
void set_fractions(SandiFit &fit) {
  const double f_e = fit.values[extra_share], g = fit.values[soma_share];
  fit.fraction = {(1.0 - f_e) * (1.0 - g), (1.0 - f_e) * g, f_e};
  if (fit.covariance.empty()) return;
  const auto spread = [&](double by_extra, double by_share) {
    const double *c = fit.covariance.data();
    const double variance = by_extra * by_extra * c[extra_share * parameters + extra_share] +
                            2.0 * by_extra * by_share * c[extra_share * parameters + soma_share] +
                            by_share * by_share * c[soma_share * parameters + soma_share];
    return std::sqrt(std::max(0.0, variance));
  };
  fit.fraction_error = {spread(-(1.0 - g), -(1.0 - f_e)), spread(-g, 1.0 - f_e), spread(1.0, 0.0)};
}

// Variance of each residual: that of the signal, else the residuals' mean square over the degrees of freedom.
std::vector<double> variances(const Model &model, const Shells &shells, double cost, std::size_t free) {
  const std::vector<double> weight = weights(model, shells);
  const std::size_t n = shells.b.size();
  std::vector<double> out(n, n > free ? cost / static_cast<double>(n - free) : 0.0);
  for (std::size_t i = 0; i < shells.error.size(); i++)
    out[i] = weight[i] * weight[i] * shells.error[i] * shells.error[i];
  return out;
}

void set_errors(const Model &model, const LeastSquares &problem, const Shells &shells, double cost,
                SandiFit &fit) {
  std::vector<bool> marked(parameters);
  std::size_t free = 0;
  for (std::size_t i = 0; i < parameters; i++) {
    const double width = problem.upper[i] - problem.lower[i];
    fit.fitted[i] = width > 0.0;
    fit.at_bound[i] = fit.fitted[i] && (fit.values[i] - problem.lower[i] < 1e-6 * width ||
                                        problem.upper[i] - fit.values[i] < 1e-6 * width);
    marked[i] = fit.fitted[i] && !fit.at_bound[i], free += fit.fitted[i];
  }
  const std::vector<double> at(fit.values.begin(), fit.values.end());
  fit.covariance = covariance(problem, at, marked, variances(model, shells, cost, free));
  fit.singular = fit.covariance.empty();
  for (std::size_t i = 0; i < parameters && !fit.singular; i++)
    fit.error[i] = std::sqrt(fit.covariance[i * parameters + i]);
}

} // namespace

SandiFit fit_sandi(const Model &model, const Sphere &sphere, const Shells &shells, std::size_t starts) {
  const LeastSquares problem = make_problem(model, sphere, shells);
  const Ends ends = search(model, sphere, problem, starts);
  const Minimum &best = ends.minima[ends.best];
  SandiFit fit;
  std::copy(best.parameters.begin(), best.parameters.end(), fit.values.begin());
  fit.converged = best.converged, fit.exchanged = ends.exchanged[ends.best], fit.starts = starts;
  const auto rms = [&](double cost) { return std::sqrt(cost / static_cast<double>(shells.b.size())); };
  fit.rms = rms(best.cost);
  for (const Minimum &end : ends.minima) {
    if (distance(model, end.parameters, best.parameters) < 1e-3)
      fit.arrived++;
    else if (end.converged && (fit.rival_rms == 0.0 || rms(end.cost) < fit.rival_rms))
      fit.rival_rms = rms(end.cost);
  }
  set_errors(model, problem, shells, best.cost, fit);
  set_fractions(fit);
  for (const double b : shells.b)
    fit.predicted.push_back(sandi_signal(model, sphere, b, best.parameters.data(), nullptr));
  return fit;
}

} // namespace conceg::fit
