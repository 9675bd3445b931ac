// SPDX-License-Identifier: BSD-3-Clause
// Signals of single compartments against goldens of an independent code, to the eighth digit, and their
// derivatives.
#include "bessel.hpp"
#include "gaussian.hpp"
#include "sphere_exact.hpp"
#include "sphere_gpd.hpp"
#include "sphere_table.hpp"

#include "check.h"

#include <vector>

using namespace conceg;
using namespace conceg::fit;

namespace {

const Timing timing; // Delta 20, delta 5
constexpr double golden_b[] = {0.5, 1, 2, 3, 5, 8, 10, 12, 15};

struct Golden {
  double radius, diffusivity, signal[9];
};
// Matrix method with 171 modes.
const Golden exact[] = {{2,
                         2,
                         {0.99638452, 0.99278141, 0.98561218, 0.97849198, 0.96439740, 0.94361541, 0.92999704,
                          0.91656483, 0.89676032}},
                        {5,
                         2,
                         {0.92107509, 0.84752295, 0.71528290, 0.60093273, 0.41769688, 0.23106442, 0.14964447,
                          0.09290352, 0.04059998}},
                        {7,
                         2,
                         {0.82185833, 0.67152741, 0.43960064, 0.27908709, 0.09969699, 0.01414930, 0.00546397,
                          0.00770362, 0.01258087}},
                        {10,
                         2,
                         {0.68302488, 0.46039461, 0.20166110, 0.08631275, 0.02265525, 0.01282599, 0.00845188,
                          0.00499315, 0.00313742}},
                        {5,
                         3,
                         {0.93497909, 0.87365200, 0.76134824, 0.66170733, 0.49548698, 0.31308836, 0.22598882,
                          0.15998967, 0.09106880}},
                        {7,
                         3,
                         {0.83595425, 0.69528467, 0.47279579, 0.31296397, 0.12292812, 0.01830204, 0.00235831,
                          0.00195099, 0.00824295}}};

void exact_spheres() {
  const SphereModes modes;
  CHECK_EQUAL(modes.mu.size(), 171);
  Workers one(1);
  const SphereTable fixed(timing, {15, 1, 15, 3, 3}, one, nullptr),
      wide(timing, {15, 1, 15, 0.5, 3}, one, nullptr);
  for (const Golden &g : exact)
    for (int i = 0; i < 9; i++) {
      CHECK_NEAR(sphere_exact(modes, timing, golden_b[i], g.radius, g.diffusivity), g.signal[i], 1e-7);
      CHECK_NEAR(wide(golden_b[i], g.radius, g.diffusivity).value, g.signal[i], 1e-7);
      if (g.diffusivity == 3) CHECK_NEAR(fixed(golden_b[i], g.radius, 3).value, g.signal[i], 1e-7);
    }
  // The corner where the modes are fewest for what they must do: 350 of them agree to 3e-6.
  const SphereModes more(52.0);
  for (const double b : {1.0, 5.0, 15.0}) {
    CHECK_NEAR(sphere_exact(modes, timing, b, 15, 0.5), sphere_exact(more, timing, b, 15, 0.5), 3e-6);
    CHECK_NEAR(sphere_exact(modes, timing, b, 7, 2), sphere_exact(more, timing, b, 7, 2), 1e-7);
  }
  // Long and weak: the Gaussian phase distribution is right. Very short pulses: [3 j1(qR) / (qR)]^2.
  const SphereGpd gpd(timing);
  CHECK_NEAR(sphere_exact(modes, timing, 0.01, 5, 2), gpd(0.01, 5, 2).value, 1e-6);
  const Timing brief{1e-3, 200.0};
  const double q = 0.5, b = q * q * (brief.separation_ms - brief.delta_ms / 3.0);
  CHECK_NEAR(sphere_exact(modes, brief, b, 5, 2), 0.24945588, 2e-4);
  Workers three(3);
  const SphereTable again(timing, {15, 1, 15, 3, 3}, three, nullptr);
  CHECK(again(7.3, 6.1, 3).value == fixed(7.3, 6.1, 3).value);
}

void gaussian_spheres() {
  const SphereGpd gpd(timing);
  const double b[] = {1, 3, 5, 10, 15};
  const struct {
    double radius, apparent, signal[5];
  } golden[] = {{2, 0.00724337, {0.99278280, 0.97850428, 0.96443112, 0.93012738, 0.89704378}},
                {5, 0.16344297, {0.84921493, 0.61242492, 0.44166003, 0.19506358, 0.08615179}},
                {7, 0.38686818, {0.67918062, 0.31329672, 0.14451949, 0.02088588, 0.00301842}},
                {10, 0.74934129, {0.47267781, 0.10560771, 0.02359533, 0.00055674, 0.00001314}}};
  for (const auto &g : golden) {
    CHECK_NEAR(gpd.apparent(g.radius, 2), g.apparent, 1e-8);
    CHECK_NEAR(gpd.radius_of(g.apparent, 2, 1, 15), g.radius, 1e-6);
    for (int i = 0; i < 5; i++)
      CHECK_NEAR(gpd(b[i], g.radius, 2).value, g.signal[i], 1e-8);
  }
  CHECK_NEAR(gpd.apparent(7, 3), 0.35357217, 1e-8);
  // The toolbox's largest radius has an apparent diffusivity of 1 um^2/ms.
  CHECK_NEAR(gpd.apparent(11.354613, 3), 1.0, 1e-6);
  CHECK_NEAR(SphereGpd({3.0, 11.0}).apparent(8.469093, 3), 1.0, 1e-6);
  CHECK_NEAR(SphereGpd({5.5, 12.5}).apparent(9.385975, 3), 1.0, 1e-6);
}

void roots() {
  const double known[] = {2.0815759778,  5.9403699906,  9.2058401429, 12.4044450219, 15.5792364104,
                          18.7426455848, 21.8996964795, 25.052825281, 28.203361004,  31.3520917266};
  const std::vector<double> found = derivative_roots(1, 200.0);
  double sum = 0.0;
  for (int i = 0; i < 10; i++)
    CHECK_NEAR(found[static_cast<std::size_t>(i)], known[i], 1e-10);
  for (const double mu : found)
    sum += 2.0 / (mu * mu * (mu * mu - 2.0));
  CHECK_NEAR(sum, 0.2, 1e-7);
  CHECK_NEAR(derivative_roots(0, 5.0)[0], 4.49340945790906, 1e-12);
  CHECK_EQUAL(derivative_roots(40, 36.0).size(), 0);
}

void averages_over_directions() {
  const double x[] = {1, 2, 10, 30}, sticks[] = {0.74682413, 0.59814401, 0.28024739, 0.16180216};
  for (int i = 0; i < 4; i++)
    CHECK_NEAR(stick(x[i]).value, sticks[i], 1e-8);
  const double y[] = {0.5, 1, 2, 5, 10},
               dawson[] = {0.4244363835, 0.5380795069, 0.3013403889, 0.1021340744, 0.0502538471};
  for (int i = 0; i < 5; i++)
    CHECK_NEAR(sheet(y[i] * y[i]).value, dawson[i] / y[i], 1e-10);
  CHECK_NEAR(ball(6).value, 2.47875218e-3, 1e-11);
  for (Attenuation (*of)(double) : {stick, ball, sheet}) {
    CHECK_NEAR(of(0).value, 1.0, 0);
    CHECK_NEAR(of(60.0 - 1e-9).value, of(60.0 + 1e-9).value, 1e-11); // the series and what follows it
    for (const double at : {1e-5, 1e-3, 0.3, 2.0, 20.0, 59.0, 80.0}) {
      const double h = 1e-5 * at;
      CHECK_NEAR(of(at).slope, (of(at + h).value - of(at - h).value) / (2 * h), 2e-6);
    }
  }
}

template <class SphereKernel> void check_derivatives(const SphereKernel &sphere) {
  const double h = 1e-5;
  for (const double b : {0.5, 4.0, 15.0})
    for (const double radius : {1.5, 4.0, 9.0, 14.0})
      for (const double d : {0.7, 1.9, 2.9}) {
        const SphereSignal s = sphere(b, radius, d);
        CHECK_NEAR(s.by_radius, (sphere(b, radius + h, d).value - sphere(b, radius - h, d).value) / (2 * h),
                   1e-7);
        CHECK_NEAR(s.by_diffusivity,
                   (sphere(b, radius, d + h).value - sphere(b, radius, d - h).value) / (2 * h), 1e-7);
      }
}

void derivatives() {
  check_derivatives(SphereGpd(timing));
  Workers workers(1);
  check_derivatives(SphereTable(timing, {15, 1, 15, 0.5, 3}, workers, nullptr));
}

} // namespace

int main() {
  roots();
  averages_over_directions();
  gaussian_spheres();
  exact_spheres();
  derivatives();
  return check_done();
}
