// SPDX-License-Identifier: BSD-3-Clause
// SANDI (Palombo et al. 2020): neurites as sticks, somas as spheres, and the space between cells. Plain
// arrays.
#pragma once

#include "signal.hpp"

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace conceg::fit {

enum class Kernel { gpd, exact };
enum class Extracellular { none, ball, sheet }; // none: the reduced model, of intracellular signals

enum Parameter { extra_share, soma_share, soma_radius, neurite_d, extra_d, soma_d, parameters };
using Values = std::array<double, parameters>;
extern const char *const parameter_names[parameters];
extern const char *const parameter_units[parameters];

// S(b) = f_e A_e(b D_e) + (1 - f_e) [g A_sphere(b, R, D_is) + (1 - g) A_stick(b D_in)], so that
// f_s = (1 - f_e) g and f_n = (1 - f_e) (1 - g): fractions of the whole signal.
struct Model {
  Kernel kernel = Kernel::gpd;
  Extracellular extracellular = Extracellular::ball;
  // A parameter whose bounds are equal is held there.
  Values lower{0, 0, 1, 0.1, 0.1, 3}, upper{1, 1, 15, 3, 3, 3};
  bool weighted = false; // residuals by the shells' standard errors, else all alike
};

// Direction averages over the signal at b = 0; b of shells above 0, one timing for all.
struct Shells {
  std::vector<double> b, signal, error; // error: standard errors; empty when unknown
};

// A sphere's signal at one timing.
struct Sphere {
  std::function<SphereSignal(double b, double radius_um, double diffusivity)> signal;
  // Of a Gaussian sphere: -ln S / b, and the radius (um) that has it. Empty for the exact kernel.
  std::function<double(double radius_um, double diffusivity)> apparent;
  std::function<double(double apparent, double diffusivity)> radius_of;
};

// The model at one b, with derivatives by the parameters where `slope` is given.
double sandi_signal(const Model &model, const Sphere &sphere, double b, const double *values, double *slope);

struct SandiFit {
  Values values{}, error{};                           // error: standard errors; 0 where held or at a bound
  std::vector<double> covariance;                     // parameters x parameters, in the order of Parameter
  std::array<double, 3> fraction{}, fraction_error{}; // neurite, soma, extracellular
  std::array<bool, parameters> fitted{}, at_bound{};
  std::vector<double> predicted; // of the shells
  double rms = 0.0;              // of the residuals, weighted where the fit is, by weights of mean square 1
  std::size_t starts = 0,
              arrived = 0; // starts that ended within 0.001 of the best fit, in widths of the bounds
  double rival_rms = 0.0;  // of the next best other minimum; 0 = there is none
  bool converged = false, singular = false, exchanged = false;
};

// Fits from `starts` points spread over the bounds. Standard errors follow from those of the signal where it
// has them, else from the residuals. With Gaussian spheres and a ball, sphere and ball can change places at
// equal cost: the sphere is then the one that decays more slowly; `exchanged` says that this rule decided.
SandiFit fit_sandi(const Model &model, const Sphere &sphere, const Shells &shells, std::size_t starts);

} // namespace conceg::fit
