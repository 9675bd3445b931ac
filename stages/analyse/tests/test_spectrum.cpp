// SPDX-License-Identifier: BSD-3-Clause
// Spectra of profiles whose spectrum is known in closed form, and paths of a skeleton.
#include "../spectrum.hpp"
#include "check.h"
#include "conceg/rng.h"

#include <cmath>
#include <complex>
#include <functional>

using namespace conceg;
using namespace conceg::analyse;

namespace {

constexpr double pi = 3.14159265358979323846, step = 0.1, length = 100;
constexpr std::size_t samples = 1000;

using LogArea = std::vector<double>;

// Spectrum of `count` profiles with ln A as `make` draws it.
Spectrum spectrum(std::size_t count, const std::function<LogArea(conceg_rng &)> &make, unsigned threads = 2) {
  AreaPaths paths;
  for (std::size_t p = 0; p < count; p++) {
    conceg_rng rng = conceg_rng_stream(11, "test.spectrum", p);
    paths.profiles.push_back({static_cast<std::uint32_t>(p), {}});
    for (const double eta : make(rng))
      paths.profiles.back().area.push_back(std::exp(eta));
  }
  SpectrumSettings settings;
  settings.bootstraps = 20;
  Workers workers(threads);
  return spectrum_of(paths, settings, workers);
}

// Gaussian bumps of height 0.5 and width 0.4 um at the given places, which wrap.
constexpr double height = 0.5, width = 0.4;
LogArea bumps(const std::vector<double> &places) {
  LogArea eta(samples, 0);
  for (const double place : places)
    for (int i = -40; i <= 40; i++) {
      const auto at = static_cast<long>(std::floor(place / step)) + i;
      const double x = static_cast<double>(at) * step - place;
      eta[static_cast<std::size_t>((at + 10 * static_cast<long>(samples)) % static_cast<long>(samples))] +=
          height * std::exp(-0.5 * x * x / (width * width));
    }
  return eta;
}
double form(double q) { // |bump|^2
  const double v = height * width * std::sqrt(2 * pi);
  return v * v * std::exp(-q * q * width * width);
}

// Mean over the bins of the plateau of a function of q.
double mean_of_plateau(const Spectrum &s, const std::function<double(double)> &f) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 2; k < s.q.size() && s.q[k] <= 0.6; k++)
    sum += f(s.q[k]), count++;
  return sum / count;
}

void constant_and_taper() {
  const Spectrum constant = spectrum(2, [](conceg_rng &) { return LogArea(samples, 0.3); });
  for (const double p : constant.raw)
    CHECK(p < 1e-20);
  CHECK_NEAR(constant.diffusivity_ratio, 1, 1e-12);
  constexpr double taper = 0.01; // per um, of ln A
  const Spectrum tapered = spectrum(2, [](conceg_rng &) {
    LogArea eta;
    for (std::size_t i = 0; i < samples; i++)
      eta.push_back(-taper * step * static_cast<double>(i));
    return eta;
  });
  for (std::size_t k = 0; k < 20; k++) {
    CHECK_NEAR(tapered.raw[k] / (taper * taper * length / (tapered.q[k] * tapered.q[k])), 1, 0.01);
    CHECK(tapered.power[k] < 1e-20);
  }
  CHECK_NEAR(tapered.raw_exponent, -2, 0.01);
}

void poisson_bumps() {
  const Spectrum s = spectrum(2000, [](conceg_rng &rng) {
    std::vector<double> places;
    for (double x = conceg_rng_exponential(&rng) / 0.2; x < length; x += conceg_rng_exponential(&rng) / 0.2)
      places.push_back(x);
    return bumps(places);
  });
  const double expected = mean_of_plateau(s, [](double q) { return 0.2 * form(q); });
  printf("Poisson bumps: plateau %.4f (%.4f), exponent %.3f\n", s.plateau, expected, s.exponent);
  CHECK_NEAR(s.plateau / expected, 1, 0.03);
  CHECK_NEAR(s.exponent, 0, 0.1);
  for (std::size_t k = 2; k < 30; k++)
    CHECK(s.power_low[k] <= s.power[k] && s.power[k] <= s.power_high[k]);
}

// Gaps of a gamma law with shape 4 (CV 0.5) and mean 5 um: S(q) = Re (1 + f) / (1 - f), f = (1 - i
// q 1.25)^-4.
void renewal() {
  const Spectrum s = spectrum(2000, [](conceg_rng &rng) {
    std::vector<double> places;
    double x = 0;
    for (int warm = 0; warm < 40 || x < 0;
         warm++) { // starts long before, so that the beginning is no place of its own
      double gap = 0;
      for (int k = 0; k < 4; k++)
        gap += 1.25 * conceg_rng_exponential(&rng);
      if (warm == 0) x = -200 * conceg_rng_uniform(&rng) - 20;
      x += gap;
      if (x >= 0) break;
    }
    for (; x < length;) {
      places.push_back(x);
      for (int k = 0; k < 4; k++)
        x += 1.25 * conceg_rng_exponential(&rng);
    }
    return bumps(places);
  });
  const auto structure = [](double q) {
    const std::complex<double> f = std::pow(std::complex<double>(1, -1.25 * q), -4);
    return ((1.0 + f) / (1.0 - f)).real();
  };
  const double expected = mean_of_plateau(s, [&](double q) { return 0.2 * form(q) * structure(q); });
  printf("renewal, CV 0.5: plateau %.5f (%.5f)\n", s.plateau, expected);
  CHECK_NEAR(s.plateau / expected, 1, 0.05);
}

void lattices() {
  const auto lattice = [](double jitter) {
    return [jitter](conceg_rng &rng) {
      std::vector<double> places;
      for (int n = 0; n < 20; n++)
        places.push_back(5.0 * n + jitter * conceg_rng_normal(&rng));
      return bumps(places);
    };
  };
  const Spectrum periodic = spectrum(2, lattice(0)); // 20 bumps: a peak at k = 20 and its multiples
  CHECK_NEAR(periodic.raw[19] / (400 / length * form(periodic.q[19])), 1, 1e-6);
  for (std::size_t k = 0; k < 60; k++)
    if ((k + 1) % 20) CHECK(periodic.raw[k] < 1e-12);
  const Spectrum jittered = spectrum(1000, lattice(0.3));
  printf("jittered lattice: exponent %.3f (2)\n", jittered.raw_exponent);
  CHECK_NEAR(jittered.raw_exponent, 2, 0.15);
}

// Ornstein-Uhlenbeck process: 2 s^2 l / (1 + q^2 l^2).
void lorentzian() {
  constexpr double sd = 0.3, l = 2;
  const Spectrum s = spectrum(2000, [](conceg_rng &rng) {
    const double keep = std::exp(-step / l);
    LogArea eta = {sd * conceg_rng_normal(&rng)};
    while (eta.size() < samples)
      eta.push_back(keep * eta.back() + sd * std::sqrt(1 - keep * keep) * conceg_rng_normal(&rng));
    return eta;
  });
  const double expected = mean_of_plateau(s, [](double q) { return 2 * sd * sd * l / (1 + q * q * l * l); });
  printf("Ornstein-Uhlenbeck: %.4f (%.4f)\n", s.plateau, expected);
  CHECK_NEAR(s.plateau / expected, 1, 0.04);
}

void parseval_and_ratio() {
  conceg_rng rng = conceg_rng_stream(2, "test.spectrum", 0);
  LogArea eta;
  double mean = 0, variance = 0;
  for (std::size_t i = 0; i < samples; i++)
    eta.push_back(conceg_rng_normal(&rng)), mean += eta.back() / samples;
  for (double &v : eta)
    v -= mean, variance += v * v / samples;
  const std::vector<double> power = power_of(eta, step);
  double sum = 0;
  for (std::size_t k = 0; k < power.size(); k++)
    sum += (2 * (k + 1) == samples ? 1 : 2) * power[k] / length;
  CHECK_NEAR(sum / variance, 1, 1e-10);
  // Half of the path has 4 times the cross-section: <A> = 2.5, <1/A> = 0.625.
  const Spectrum two = spectrum(2, [](conceg_rng &) {
    LogArea e(samples, 0);
    for (std::size_t i = samples / 2; i < samples; i++)
      e[i] = std::log(4.0);
    return e;
  });
  CHECK_NEAR(two.diffusivity_ratio, 1 / (2.5 * 0.625), 1e-12);
}

// A stem of 40 um, two branches of 90 and of 50 um: one path is long enough.
void paths_of_a_skeleton() {
  Skeletons s;
  s.cell_offset = {0, 0};
  const auto add = [&](double x, double y, std::int64_t parent, double r, std::uint8_t kind = 3) {
    s.position.push_back({x, y, 0}), s.parent.push_back(parent);
    s.radius.push_back(static_cast<float>(r)), s.kind.push_back(kind);
    return static_cast<std::int64_t>(s.position.size()) - 1;
  };
  std::int64_t last = -1;
  for (int i = 0; i <= 20; i++)
    last = add(2.0 * i, 0, last, 1);
  const std::int64_t fork = last;
  for (int i = 1; i <= 45; i++)
    last = add(40, 2.0 * i, last, 0.5);
  last = fork;
  for (int i = 1; i <= 25; i++)
    last = add(40, -2.0 * i, last, 0.5);
  s.cell_offset[1] = s.position.size();
  const SpectrumSettings settings;
  const AreaPaths paths = area_paths(s, {0}, false, settings);
  CHECK_EQUAL(paths.tips, 2u);
  CHECK_EQUAL(paths.profiles.size(), 1u);
  CHECK_EQUAL(paths.profiles[0].area.size(), samples);
  CHECK_NEAR(paths.profiles[0].area[0], pi, 1e-9);            // 10 um from the root
  CHECK_NEAR(paths.profiles[0].area[310], pi * 0.5625, 1e-6); // 41 um: half of the way from 1 to 0.5
  CHECK_NEAR(paths.profiles[0].area[999], pi * 0.25, 1e-9);
  CHECK_NEAR(paths.spacing, 2, 1e-9);
  Workers workers(1);
  const Spectrum spectrum = spectrum_of(paths, settings, workers);
  CHECK(spectrum.q.back() <= pi / 2 && spectrum.q.back() > 1.5);
  s.kind.assign(s.kind.size(), 2);
  CHECK_EQUAL(area_paths(s, {0}, false, settings).tips, 0u);
  CHECK_EQUAL(area_paths(s, {0}, true, settings).profiles.size(), 1u);
}

void threads() {
  const auto make = [](conceg_rng &rng) {
    LogArea eta;
    for (std::size_t i = 0; i < samples; i++)
      eta.push_back(0.1 * conceg_rng_normal(&rng));
    return eta;
  };
  const Spectrum one = spectrum(30, make, 1), three = spectrum(30, make, 3);
  CHECK(one.power == three.power && one.raw_high == three.raw_high && one.plateau == three.plateau);
}

} // namespace

int main() {
  constant_and_taper();
  poisson_bumps();
  renewal();
  lattices();
  lorentzian();
  parseval_and_ratio();
  paths_of_a_skeleton();
  threads();
  return check_done();
}
