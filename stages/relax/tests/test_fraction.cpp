// SPDX-License-Identifier: BSD-3-Clause
// Volume fractions against formulas, inflation and deflation to a fraction that is known, and the ways in
// which they stop.
#include "../inflate.hpp"
#include "check.h"
#include "scene.hpp"

#include <cmath>

using namespace conceg;
using namespace conceg::relax;

namespace {

const double pi = std::acos(-1.0);

// Parallel cables through a periodic box of 10 um, 2.5 um apart: 16 of them, volume by formula.
Bodies cables(float radius) {
  Skeletons s;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      scene::add_cable(s, {2.5 * i, 2.5 * j, 0}, {0, 0, 1}, 11, radius); // its end is the image of its start
  return make_bodies(s, 0.1);
}

double planes(const Bodies &bodies, double gap, unsigned threads) {
  Workers workers(threads);
  const conceg_box box = scene::box_of(10);
  const Sample sample = make_sample(bodies, bodies.radius, box, 100000, gap, workers);
  return fractions_of(bodies, bodies.radius, side(box), sample, gap, workers).planes;
}

void fractions_by_formula() {
  Workers workers(2);
  const conceg_box box = scene::box_of(10);
  const Bodies bodies = cables(0.8f);
  const Sample sample = make_sample(bodies, bodies.radius, box, 100000, 0.04, workers);
  const Fractions f = fractions_of(bodies, bodies.radius, side(box), sample, 0.04, workers);
  printf("cables: united %.4f, by formula %.4f\n", f.united, 16 * pi * 0.64 / 100);
  CHECK_NEAR(f.united, 16 * pi * 0.64 / 100, 0.003);
  // Wider than their distance: contact planes make squares of 2.5 um, the whole box; a gap takes its share of
  // them, and more where a cable meets its image's end.
  CHECK_NEAR(planes(cables(2.0f), 1e-9, 2), 1, 1e-4);
  const double squares = planes(cables(2.0f), 0.1, 1);
  CHECK(squares < 2.4 * 2.4 / 6.25 && squares > 0.8);
  CHECK(squares == planes(cables(2.0f), 0.1, 3));
}

Inflation inflate(double asked, double mean) {
  Workers workers(2);
  const conceg_box box = scene::box_of(10);
  const Bodies bodies = cables(0.8f);
  const Sample sample = make_sample(bodies, inflated(bodies, bodies.radius, 1e9), box, 100000, 1e-9, workers);
  return inflate_to(bodies, bodies.radius, bodies.radius, std::vector<std::uint32_t>(16, 0), 1, side(box),
                    sample, 1e-9, asked, {mean, 0.1}, workers);
}

void inflation_has_a_known_end() {
  // 16 pi r^2 = 0.36 * 100 at r = 0.8463.
  const Inflation reached = inflate(0.36, 0.15);
  printf("inflation %.4f um to %.4f\n", reached.c, reached.fraction);
  CHECK(reached.stop == Inflation::Stop::none);
  CHECK_NEAR(reached.fraction, 0.36, 0.001);
  CHECK_NEAR(reached.c, std::sqrt(36 / (16 * pi)) - 0.8, 0.01);
  const Inflation mean = inflate(0.9, 0.15);
  CHECK(mean.stop == Inflation::Stop::mean && mean.of_class == 0);
  CHECK_NEAR(mean.c, 0.15 * 0.8, 1e-4);
  const Inflation quarter = inflate(0.9, 0.5);
  CHECK(quarter.stop == Inflation::Stop::quarter);
  CHECK_NEAR(quarter.c, 0.25 * 0.8, 1e-6);
}

// The way back: 16 pi r^2 = 0.25 * 100 at r = 0.7052, which is 0.118 of 0.8; to 0.1 a quarter is not enough.
void deflation_has_a_known_end() {
  Workers workers(2);
  const conceg_box box = scene::box_of(10);
  const Bodies bodies = cables(0.8f);
  const Sample sample = make_sample(bodies, bodies.radius, box, 100000, 1e-9, workers);
  const auto to = [&](double asked) {
    return deflate_to(bodies, bodies.radius, side(box), sample, 1e-9, asked, workers);
  };
  const Inflation reached = to(0.25);
  CHECK(reached.stop == Inflation::Stop::none);
  CHECK_NEAR(reached.fraction, 0.25, 0.001);
  CHECK_NEAR(reached.c, std::sqrt(25 / (16 * pi)) - 0.8, 0.01);
  CHECK_NEAR(inflated(bodies, bodies.radius, reached.c)[5], 0.8 + reached.c, 1e-6);
  const Inflation quarter = to(0.1);
  CHECK(quarter.stop == Inflation::Stop::quarter);
  CHECK_NEAR(quarter.fraction, 16 * pi * 0.36 / 100, 0.003);
  CHECK_NEAR(to(0.9).c, 0, 0); // there already
  // No radius falls below its floor: thin cables stay as they are.
  CHECK_NEAR(inflated(cables(0.1f), cables(0.1f).radius, -1)[5], 0.1, 1e-6);
}

// Two thin and two thick cables: c is as much for both, until the thin ones have got a quarter.
void spread_is_kept() {
  Workers workers(2);
  const conceg_box box = scene::box_of(10);
  Skeletons s;
  for (int i = 0; i < 4; i++)
    scene::add_cable(s, {2.5 * i + 1, 5, 1}, {0, 0, 0.5}, 17, i < 2 ? 0.2f : 0.8f);
  const Bodies bodies = make_bodies(s, 0.1);
  const Sample sample = make_sample(bodies, inflated(bodies, bodies.radius, 1e9), box, 100000, 1e-9, workers);
  const auto to = [&](double cv) {
    return inflate_to(bodies, bodies.radius, bodies.radius, std::vector<std::uint32_t>(4, 0), 1, side(box),
                      sample, 1e-9, 0.0447, {10, cv}, workers);
  };
  const Inflation kept = to(0.05);
  CHECK(kept.stop == Inflation::Stop::cv);
  const std::vector<double> wide = inflated(bodies, bodies.radius, kept.c);
  const ClassRadii radii = class_radii(bodies, wide, bodies.radius, std::vector<std::uint32_t>(4, 0), 1)[0];
  CHECK_NEAR(radii.cv_ratio(), 1.05, 1e-3);
  CHECK(to(10).stop != Inflation::Stop::cv && to(10).c > kept.c);
}

} // namespace

int main() {
  fractions_by_formula();
  inflation_has_a_known_end();
  deflation_has_a_known_end();
  spread_is_kept();
  return check_done();
}
