// SPDX-License-Identifier: BSD-3-Clause
// Draws against the moments of their laws, which are integrated numerically here; a neighbouring law is told
// apart by the same test.
#include "../laws.hpp"

#include "check.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

using namespace conceg::place;

static const int kDraws = 200000;

struct Moments {
  double mean = 0.0, square = 0.0, fourth = 0.0; // of x, x^2, x^4
};

// Simpson's rule over [lo, hi].
template <class Density> static Moments integrate(double lo, double hi, Density density) {
  const int steps = 20000;
  double sum = 0.0, x1 = 0.0, x2 = 0.0, x4 = 0.0;
  for (int i = 0; i <= steps; i++) {
    const double x = lo + (hi - lo) * i / steps;
    const double weight = (i == 0 || i == steps ? 1.0 : i % 2 ? 4.0 : 2.0) * density(x);
    sum += weight, x1 += weight * x, x2 += weight * x * x, x4 += weight * x * x * x * x;
  }
  return {x1 / sum, x2 / sum, x4 / sum};
}

static Moments of_cosine(double kappa) {
  return integrate(0.0, 1.0, [=](double t) { return std::exp(kappa * (t * t - 1.0)); });
}

// How many standard errors the mean of x^2 is away from what it should be.
static double off(const Moments &drawn, const Moments &law) {
  return (drawn.square - law.square) / std::sqrt((law.fourth - law.square * law.square) / kDraws);
}

static void check_watson(double kappa) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 0.5)),
                   aside = glm::normalize(glm::cross(axis, {0, 1, 0}));
  Moments drawn;
  glm::dvec3 sum(0.0);
  double across = 0.0;
  for (int i = 0; i < kDraws; i++) {
    conceg_rng rng = conceg_rng_stream(1, "test.watson", static_cast<std::uint64_t>(i));
    const glm::dvec3 u = draw_direction({axis, kappa}, rng);
    const double cosine = glm::dot(u, axis), square = cosine * cosine;
    if (i < 100) CHECK_NEAR(glm::length(u), 1.0, 1e-12);
    drawn.square += square / kDraws, drawn.fourth += square * square / kDraws;
    across += glm::dot(u, aside) * glm::dot(u, aside) / kDraws;
    sum += u;
  }
  const Moments law = of_cosine(kappa);
  std::printf("kappa %g: <cos2> %.5f, law %.5f\n", kappa, drawn.square, law.square);
  CHECK(std::fabs(off(drawn, law)) < 4.0);
  CHECK_NEAR(drawn.fourth, law.fourth, 0.005);
  CHECK_NEAR(across, 0.5 * (1.0 - law.square), 0.005);                    // all azimuths alike
  CHECK(glm::length(sum) < 4.0 * std::sqrt(static_cast<double>(kDraws))); // both signs alike
  CHECK(std::fabs(off(drawn, of_cosine(1.1 * kappa + 0.5))) > 6.0);
}

static void check_closed_form() {
  CHECK_NEAR(of_cosine(0.0).square, 1.0 / 3.0, 1e-12);
  // <cos2> = 1 / (2 sqrt(k) F(sqrt(k))) - 1 / (2 k) with Dawson's F(1) = 0.5380795069127684.
  CHECK_NEAR(of_cosine(1.0).square, 0.5 / 0.5380795069127684 - 0.5, 1e-10);
}

static void check_gamma(const GammaLaw &law) {
  std::vector<double> values;
  Moments drawn;
  double least = 1e9;
  for (int i = 0; i < kDraws; i++) {
    conceg_rng rng = conceg_rng_stream(2, "test.gamma", static_cast<std::uint64_t>(i));
    const double x = draw_gamma(law, rng);
    drawn.mean += x / kDraws, drawn.square += x * x / kDraws;
    least = std::fmin(least, x);
  }
  const double shape = law.mean * law.mean / (law.sd * law.sd), scale = law.mean / shape;
  const auto density = [=](double x) { return std::exp((shape - 1.0) * std::log(x / law.mean) - x / scale); };
  const Moments cut = integrate(law.minimum, law.mean + 30.0 * law.sd, density);
  std::printf("gamma %g +- %g cut at %g: mean %.5f, law %.5f\n", law.mean, law.sd, law.minimum, drawn.mean,
              cut.mean);
  const double sd = std::sqrt(cut.square - cut.mean * cut.mean);
  CHECK(least >= law.minimum);
  CHECK_NEAR(drawn.mean, cut.mean, 4.0 * sd / std::sqrt(static_cast<double>(kDraws)));
  CHECK_NEAR(drawn.square, cut.square, 0.01 * cut.square);
  CHECK(std::fabs(drawn.mean - law.mean) >
        10.0 * sd / std::sqrt(static_cast<double>(kDraws))); // the cut shows
}

int main() {
  check_closed_form();
  for (const double kappa : {0.0, 0.1, 1.0, 5.0, 30.0, 2000.0})
    check_watson(kappa);
  check_gamma({0.35, 0.1, 0.25});
  check_gamma({0.35, 0.2, 0.3});
  check_gamma({1.0, 1.0, 0.5}); // exponential: mean 1.5
  conceg_rng rng = conceg_rng_stream(3, "test.gamma", 1);
  CHECK_NEAR(draw_gamma({0.4, 0.0, 0.3}, rng), 0.4, 0.0);
  return check_done();
}
