// SPDX-License-Identifier: BSD-3-Clause
// The model against goldens, fits of signals whose parameters are known, and the bias that the model alone
// explains.
#include "kernels.hpp"
#include "sphere_exact.hpp"

#include "gaussian.hpp"

#include "conceg/rng.h"

#include "check.h"

#include <algorithm>
#include <cmath>

using namespace conceg;
using namespace conceg::fit;

namespace {

const Timing timing;
Workers workers(1);

void hold(Model &model, Parameter p, double value) {
  model.lower[p] = model.upper[p] = value;
}

Model reduced(double soma_diffusivity, double neurite_diffusivity = 0.0) {
  Model m;
  m.extracellular = Extracellular::none;
  hold(m, extra_share, 0), hold(m, extra_d, 1), hold(m, soma_d, soma_diffusivity);
  if (neurite_diffusivity > 0) hold(m, neurite_d, neurite_diffusivity);
  return m;
}

Sphere sphere_of(const Model &model) {
  return make_sphere(model, timing, 15.0, workers, nullptr);
}

Shells forward(const Model &model, const Sphere &sphere, const Values &v) {
  Shells s;
  for (int b = 1; b <= 15; b++)
    s.b.push_back(b), s.signal.push_back(sandi_signal(model, sphere, b, v.data(), nullptr));
  return s;
}

void goldens() {
  const double b[] = {0, 0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15};
  const double a[] = {1,          0.72296307, 0.54987090, 0.35973097, 0.26498173, 0.21076873,
                      0.17628463, 0.15263129, 0.12269838, 0.10492435, 0.09332527, 0.08189592};
  const double second[] = {1,          0.68389559, 0.49017697, 0.28341022, 0.18859051, 0.14139088,
                           0.11592663, 0.10089244, 0.08419724, 0.07463856, 0.06799641, 0.06078609};
  const double c[] = {1,          0.76614914, 0.61840316, 0.44610210, 0.34953029, 0.28817778,
                      0.24631541, 0.21641228, 0.17748692, 0.15384624, 0.13808383, 0.12210622};
  Model full;
  const Model without = reduced(2);
  const Sphere sphere = sphere_of(full);
  const Values va{0.3, 0.2 / 0.7, 7, 2, 1, 3}, vb{0.30, 0.28 / 0.70, 10, 2.5, 0.8, 3},
      vc{0, 0.25, 7, 2, 1, 2};
  for (int i = 0; i < 12; i++) {
    CHECK_NEAR(sandi_signal(full, sphere, b[i], va.data(), nullptr), a[i], 1e-8);
    CHECK_NEAR(sandi_signal(full, sphere, b[i], vb.data(), nullptr), second[i], 1e-8);
    CHECK_NEAR(sandi_signal(without, sphere, b[i], vc.data(), nullptr), c[i], 1e-8);
  }
}

void slopes() {
  Model model;
  for (const Extracellular e : {Extracellular::ball, Extracellular::sheet}) {
    model.extracellular = e;
    const Sphere sphere = sphere_of(model);
    Values v{0.3, 0.4, 6, 1.8, 0.9, 2.5};
    double slope[parameters];
    sandi_signal(model, sphere, 3.0, v.data(), slope);
    for (std::size_t p = 0; p < parameters; p++) {
      Values up = v, down = v;
      up[p] += 1e-6, down[p] -= 1e-6;
      CHECK_NEAR(slope[p],
                 (sandi_signal(model, sphere, 3.0, up.data(), nullptr) -
                  sandi_signal(model, sphere, 3.0, down.data(), nullptr)) /
                     2e-6,
                 1e-8);
    }
  }
}

// Signals that the model itself made give their parameters back.
void recovered(Model model, const Values &truth, double tolerance, std::size_t starts) {
  const Sphere sphere = sphere_of(model);
  const SandiFit fit = fit_sandi(model, sphere, forward(model, sphere, truth), starts);
  CHECK(fit.converged && fit.arrived >= 1 && fit.rms < 1e-8);
  for (std::size_t p = 0; p < parameters; p++)
    if (fit.fitted[p]) CHECK_NEAR(fit.values[p], truth[p], tolerance);
  CHECK_NEAR(fit.fraction[0] + fit.fraction[1] + fit.fraction[2], 1.0, 1e-12);
  CHECK_NEAR(fit.fraction[1], (1 - truth[extra_share]) * truth[soma_share], tolerance);
}

void self_consistent() {
  recovered(reduced(3), {0, 0.25, 7, 2, 1, 3}, 1e-6, 24);
  Model full;
  recovered(full, {0.31, 0.25, 7, 2, 1, 3}, 1e-6, 24);
  full.extracellular = Extracellular::sheet;
  recovered(full, {0.31, 0.25, 7, 2, 1, 3}, 1e-6, 24);
  Model exact = reduced(2);
  exact.kernel = Kernel::exact;
  recovered(exact, {0, 0.41, 6, 1.7, 1, 2}, 1e-6, 12);
  exact.lower[soma_d] = 0.5, exact.upper[soma_d] = 3; // the soma's diffusivity too: the exact sphere can tell
  recovered(exact, {0, 0.25, 7, 2, 1, 2}, 1e-4, 24);
}

// Exact spheres and sticks, fitted by the published model: what it makes of a perfect simulation.
struct Bias {
  double f, radius, soma_d, neurite_d, fitted_f, fitted_radius, fitted_d, rms;
};
void bias() {
  const Bias table[] = {{.25, 7, 3, 0, .2821, 7.867, 1.839, 2.0e-3},
                        {.25, 7, 2, 0, .2821, 7.703, 1.839, 2.0e-3},
                        {.25, 7, 3, 2, .2623, 7.518, 2, 2.8e-3},
                        {.25, 7, 2, 2, .2623, 7.304, 2, 2.8e-3},
                        {.41, 7, 3, 0, .4658, 7.885, 1.648, 3.2e-3},
                        {.41, 7, 2, 2, .4301, 7.304, 2, 4.6e-3},
                        {.25, 5, 3, 0, .2981, 5.468, 2.126, 3.2e-4},
                        {.25, 5, 2, 2, .2830, 5.232, 2, 1.6e-3},
                        // the three layers of the paper's Table 2, by the composition it states
                        {.25, 7.0, 3, 0, .282, 7.87, 0, 0},
                        {.41, 7.2, 3, 0, .470, 8.16, 0, 0},
                        {.26, 6.9, 3, 0, .293, 7.73, 0, 0}};
  const SphereModes modes;
  for (const Bias &row : table) {
    Shells s;
    for (int b = 1; b <= 15; b++)
      s.b.push_back(b), s.signal.push_back(row.f * sphere_exact(modes, timing, b, row.radius, 2) +
                                           (1 - row.f) * stick(2 * b).value);
    Model model = reduced(row.soma_d, row.neurite_d);
    const SandiFit fit = fit_sandi(model, sphere_of(model), s, 24);
    CHECK_NEAR(fit.fraction[1], row.fitted_f, 1e-3);
    CHECK_NEAR(fit.values[soma_radius], row.fitted_radius, 6e-3);
    if (row.fitted_d > 0) CHECK_NEAR(fit.values[neurite_d], row.fitted_d, 1e-3);
    // That table's mean is over 16 values of b, with b = 0.
    if (row.rms > 0) CHECK_NEAR(fit.rms * std::sqrt(15.0 / 16.0), row.rms, 0.03 * row.rms);
    model.kernel = Kernel::exact; // the remedy: the exact sphere with the diffusivity of the simulation
    if (row.soma_d != 2) continue;
    const SandiFit right = fit_sandi(model, sphere_of(model), s, 12);
    CHECK_NEAR(right.fraction[1], row.f, 1e-6);
    CHECK_NEAR(right.values[soma_radius], row.radius, 1e-5);
  }
}

// A sphere that decays faster than the ball: the fit gives the other order, at the same cost.
void exchange() {
  Model model;
  const Sphere sphere = sphere_of(model);
  const double ball_d = 0.4, adc = sphere.apparent(10, 3); // 0.80
  const Values truth{0.3, 0.4, 10, 2, ball_d, 3};
  const SandiFit fit = fit_sandi(model, sphere, forward(model, sphere, truth), 24);
  CHECK(adc > ball_d && fit.rms < 1e-8);
  CHECK_NEAR(fit.values[extra_d], adc, 1e-5);
  CHECK_NEAR(fit.values[soma_radius], sphere.radius_of(ball_d, 3), 1e-5);
  CHECK_NEAR(fit.fraction[2], 0.28, 1e-5); // what was the sphere's
  CHECK_NEAR(fit.fraction[1], 0.30, 1e-5);
  CHECK(sphere.apparent(fit.values[soma_radius], 3) <= fit.values[extra_d]);
}

void bounds() {
  Model model = reduced(3);
  const Sphere sphere = sphere_of(model);
  const Shells s = forward(model, sphere, {0, 0.25, 7, 2, 1, 3});
  model.upper[soma_radius] = 6;
  const SandiFit fit = fit_sandi(model, sphere, s, 12);
  CHECK_NEAR(fit.values[soma_radius], 6, 1e-6);
  CHECK(fit.at_bound[soma_radius] && !fit.at_bound[soma_share] && fit.error[soma_radius] == 0.0);
  CHECK(fit.error[soma_share] > 0.0);
  // Without somas the radius means nothing.
  model = reduced(3);
  const SandiFit none = fit_sandi(model, sphere, forward(model, sphere, {0, 0.0, 7, 2, 1, 3}), 12);
  CHECK(none.at_bound[soma_share] || none.error[soma_radius] > 1.0);
}

// Standard errors against the spread of fits to noisy signals.
void errors() {
  const Model model = reduced(3);
  const Sphere sphere = sphere_of(model);
  const Shells clean = forward(model, sphere, {0, 0.3, 7, 2, 1, 3});
  constexpr int runs = 300;
  constexpr double noise = 1e-3;
  double sum[3] = {}, squares[3] = {}, said[3] = {}, from_residuals = 0.0;
  for (int run = 0; run < runs; run++) {
    Shells s = clean;
    conceg_rng rng = conceg_rng_stream(1, "fit.test", static_cast<std::uint64_t>(run));
    for (double &v : s.signal)
      v += noise * conceg_rng_normal(&rng);
    Shells known = s;
    known.error.assign(s.b.size(), noise);
    const SandiFit fit = fit_sandi(model, sphere, known, 2);
    const double value[3] = {fit.fraction[1], fit.values[soma_radius], fit.values[neurite_d]},
                 error[3] = {fit.fraction_error[1], fit.error[soma_radius], fit.error[neurite_d]};
    for (int k = 0; k < 3; k++)
      sum[k] += value[k], squares[k] += value[k] * value[k], said[k] += error[k];
    from_residuals += fit_sandi(model, sphere, s, 2).error[soma_radius];
  }
  for (int k = 0; k < 3; k++) {
    const double sd = std::sqrt((squares[k] - sum[k] * sum[k] / runs) / (runs - 1));
    CHECK_NEAR(said[k] / runs / sd, 1.0, 0.15); // 4 % is one standard error of the sd
  }
  CHECK_NEAR(from_residuals / said[1], 1.0, 0.1);
}

// Shells whose errors differ tenfold: weights bring the fit nearer to the truth, by as much as the standard
// errors say.
void weighted() {
  Model plain = reduced(3), model = plain;
  model.weighted = true;
  const Sphere sphere = sphere_of(model);
  const Shells clean = forward(model, sphere, {0, 0.3, 7, 2, 1, 3});
  constexpr int runs = 200;
  double sum = 0.0, squares = 0.0, plain_squares = 0.0, said = 0.0, plain_said = 0.0;
  for (int run = 0; run < runs; run++) {
    Shells s = clean;
    conceg_rng rng = conceg_rng_stream(1, "fit.test.weights", static_cast<std::uint64_t>(run));
    for (std::size_t i = 0; i < s.b.size(); i++) {
      s.error.push_back(i < 5 ? 2e-3 : 2e-4);
      s.signal[i] += s.error[i] * conceg_rng_normal(&rng);
    }
    const SandiFit fit = fit_sandi(model, sphere, s, 2), other = fit_sandi(plain, sphere, s, 2);
    const double off = fit.values[soma_radius] - 7.0, other_off = other.values[soma_radius] - 7.0;
    sum += off, squares += off * off, plain_squares += other_off * other_off;
    said += fit.error[soma_radius] / runs, plain_said += other.error[soma_radius] / runs;
  }
  const double sd = std::sqrt((squares - sum * sum / runs) / (runs - 1));
  CHECK_NEAR(said / sd, 1.0, 0.18); // 5 % is one standard error of the sd
  CHECK_NEAR(plain_said / std::sqrt(plain_squares / runs), 1.0, 0.18);
  CHECK(squares < 0.5 * plain_squares);
}

} // namespace

int main() {
  weighted();
  goldens();
  slopes();
  self_consistent();
  bias();
  exchange();
  bounds();
  errors();
  return check_done();
}
