// SPDX-License-Identifier: BSD-3-Clause
// Laws that walkers must keep: free diffusion, displacements in pores, the surface-to-volume law of short
// times, absorption through a permeable wall, detailed balance, exchange (Karger), the order of the mesh's
// error, a cut cylinder. test_physics [SEED FACTOR]: FACTOR times the walkers; every value is printed with
// its z score.
#include "shapes.hpp"
#include "statistics.hpp"

#include "../protocol.hpp"
#include "../signals.hpp"

#include "check.h"

using namespace conceg;
using namespace conceg::simulate;
using namespace conceg::simulate::testing;

namespace {

std::uint64_t seed = 1;
std::size_t factor = 1;
double worst = 0.0;
ChiSquare all;

void report(const char *what, double mean, double error, double expected) {
  const double z = error > 0.0 ? (mean - expected) / error : 0.0;
  std::printf("  %-44s %.6f (%.1e), expected %.6f, z %+.2f\n", what, mean, error, expected, z);
  worst = std::max(worst, std::fabs(z));
}
// Correlated values of one case.
void hold(const char *what, const std::vector<std::vector<double>> &sample,
          const std::vector<double> &expected) {
  const Deviation d = deviation(sample, expected);
  for (std::size_t i = 0; i < expected.size(); i++)
    report(what, d.mean[i], d.error[i], expected[i]);
  all.add(d.chi2);
}
void hold_one(const char *what, double mean, double error, double expected) {
  report(what, mean, error, expected);
  all.value += (mean - expected) * (mean - expected) / error / error, all.degrees++;
}

std::vector<Start> starts_in_sphere(const Walls &walls, const glm::dvec3 &centre, double radius,
                                    std::size_t count) {
  std::vector<Start> out;
  for (std::uint64_t i = 0; i < count; i++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.start", i);
    glm::dvec3 p;
    do {
      for (int axis = 0; axis < 3; axis++)
        p[axis] = radius * (2.0 * conceg_rng_uniform(&rng) - 1.0);
    } while (glm::length(p) > radius);
    out.push_back({walls.local(centre + 0.999 * p), true, i});
  }
  return out;
}

std::vector<Walk> go(const Walls &walls, const Timeline &timeline, const Physics &physics,
                     const std::vector<Start> &start, Workers &workers) {
  std::vector<Walk> out(start.size());
  std::vector<Tally> tally(workers.threads());
  workers.loop((start.size() + 15) / 16, 1, [&](std::size_t b, unsigned worker) {
    const std::size_t begin = 16 * b, many = std::min<std::size_t>(16, start.size() - begin);
    const std::vector<Walk> part = walk(walls, timeline, physics, &start[begin], many, seed, tally[worker]);
    std::copy(part.begin(), part.end(), out.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  return out;
}

Timeline recorded(const std::vector<double> &times) {
  Timeline t;
  record_at(t, times);
  return t;
}

void test_free(Workers &workers) {
  const conceg_box box = cube(20.0);
  const Walls walls(box, Membranes(), 0.12, workers, Progress());
  for (const bool jumps : {true, false}) {
    Physics physics;
    physics.jumps = jumps;
    Protocol protocol = pulsed(
        {{1.0, {1, 0, 0}, 5, 20, 25, 0}, {3.0, {0, 1, 0}, 5, 20, 25, 0}, {0.5, {0, 0, 1}, 5, 20, 25, 0}});
    record_at(protocol.timeline, {0.01, 25.0});
    const std::size_t count = (jumps ? 40000 : 300) * factor;
    std::vector<Start> start;
    for (std::uint64_t i = 0; i < count; i++)
      start.push_back({glm::dvec3(10.0), false, i});
    const std::vector<Walk> walks = go(walls, protocol.timeline, physics, start, workers);
    std::vector<std::vector<double>> sample;
    double second = 0.0, fourth = 0.0;
    for (const Walk &w : walks) {
      std::vector<double> row;
      for (std::size_t r = 0; r < 3; r++)
        row.push_back(std::cos(glm::dot(protocol.coefficient[r], w.vector[0])));
      row.push_back(glm::dot(w.displacement[1], w.displacement[1]));
      row.push_back(glm::dot(w.displacement[0], w.displacement[0]));
      sample.push_back(row);
      for (int a = 0; a < 3; a++)
        second += std::pow(w.displacement[0][a], 2) / 3.0, fourth += std::pow(w.displacement[0][a], 4) / 3.0;
    }
    hold(jumps ? "free, jumps: S at b 1, 3, 0.5; MSD at 25, 0.01"
               : "free, steps: S at b 1, 3, 0.5; MSD at 25, 0.01",
         sample, {0.13533528, 2.47875218e-3, std::exp(-1.0), 300.0, 0.12});
    if (jumps) continue;
    // Ten steps of fixed length.
    const double n = static_cast<double>(count);
    std::printf("  free, ten steps: excess kurtosis %.3f (%.3f), -6/(5 n) = -0.120\n",
                n * fourth / second / second - 3.0, std::sqrt(8.0 / n));
    CHECK_NEAR(n * fourth / second / second - 3.0, -0.12, 4.5 * std::sqrt(8.0 / n));
  }
}

// K(t) of one axis, in the limit: that of the difference of two places in the pore.
void hold_kurtosis(const char *what, const std::vector<Walk> &walks, std::size_t record, double time,
                   int axis, double expected) {
  std::vector<glm::dvec3> moved;
  std::vector<std::uint32_t> walker;
  for (const Walk &w : walks)
    walker.push_back(static_cast<std::uint32_t>(moved.size())), moved.push_back(w.displacement[record]);
  const Mean k = spread_of(moved.data(), walker, time).kurtosis[axis];
  hold_one(what, k.value, k.error, expected);
}

// Displacements in pores: mean squares (sphere, series of eigenvalues), short-pulse signals after 10 ms and
// in the limit.
void test_displacements(Workers &workers) {
  const conceg_box box = cube(12.0);
  const std::vector<double> times = {1.0, 5.0, 10.0, 20.0, 50.0};
  const Timeline timeline = recorded(times);
  const double q[3] = {0.2, 0.5, 0.8};
  const Physics physics;
  {
    Membranes m;
    add_sphere(m, glm::dvec3(6.0), 5.0, 5);
    const Walls walls(box, m, 0.12, workers, Progress());
    std::vector<std::vector<double>> msd, signal;
    const std::vector<Walk> walks =
        go(walls, timeline, physics, starts_in_sphere(walls, glm::dvec3(6.0), 5.0, 800 * factor), workers);
    for (const Walk &w : walks) {
      std::vector<double> row, cosines;
      for (std::size_t t = 0; t < 4; t++)
        row.push_back(glm::dot(w.displacement[t], w.displacement[t]));
      for (const std::size_t t : {2u, 4u})
        for (const double k : q)
          cosines.push_back((std::cos(k * w.displacement[t].x) + std::cos(k * w.displacement[t].y) +
                             std::cos(k * w.displacement[t].z)) /
                            3.0);
      msd.push_back(row), signal.push_back(cosines);
    }
    hold("sphere 5: MSD at 1, 5, 10, 20 ms", msd, {9.00082200, 24.75533543, 29.07315800, 29.97105446});
    hold("sphere 5: short pulses, 10 ms and limit", signal,
         {0.82169887, 0.26502953, 0.01513474, 0.81632316, 0.24945588, 0.00758346});
    hold_kurtosis("sphere 5: K_x in the limit", walks, 4, 50.0, 0, -3.0 / 7.0);
  }
  {
    Membranes m;
    add_cylinder(m, 6.0, 6.0, 5.0, 12.0, 256);
    const Walls walls(box, m, 0.12, workers, Progress());
    std::vector<Start> start;
    for (std::uint64_t i = 0; i < 500 * factor; i++) {
      conceg_rng rng = conceg_rng_stream(seed, "test.cylinder", i);
      const double r = 4.99 * std::sqrt(conceg_rng_uniform(&rng)), a = 2.0 * M_PI * conceg_rng_uniform(&rng);
      start.push_back(
          {{6.0 + r * std::cos(a), 6.0 + r * std::sin(a), 12.0 * conceg_rng_uniform(&rng)}, true, i});
    }
    std::vector<std::vector<double>> signal, spread;
    const std::vector<Walk> walks = go(walls, timeline, physics, start, workers);
    for (const Walk &w : walks) {
      std::vector<double> row;
      spread.emplace_back();
      for (std::size_t t = 0; t < 3; t++)
        spread.back().push_back((std::pow(w.displacement[t].x, 2) + std::pow(w.displacement[t].y, 2)) /
                                (4.0 * times[t]));
      for (const std::size_t t : {2u, 4u})
        for (const double k : q)
          row.push_back(0.5 * (std::cos(k * w.displacement[t].x) + std::cos(k * w.displacement[t].y)));
      // Along the cylinder, which the box cuts: free.
      row.push_back(std::cos(0.2 * w.displacement[2].z)),
          row.push_back(w.displacement[4].z * w.displacement[4].z);
      signal.push_back(row);
    }
    hold("cylinder 5: short pulses; along it free", signal,
         {0.78853025, 0.19343985, 0.01225514, 0.77457807, 0.15814563, 0.00109043, std::exp(-0.04 * 20.0),
          200.0});
    // D(t) = R^2 / (4 t) (1 - 8 sum exp(-mu^2 D t / R^2) / (mu^2 (mu^2 - 1))), J1'(mu) = 0.
    std::vector<double> expected;
    for (std::size_t t = 0; t < 3; t++) {
      double sum = 0.0;
      for (const double mu : {1.8411837813, 5.3314427735, 8.5363163663, 11.7060049026})
        sum += std::exp(-mu * mu * 2.0 * times[t] / 25.0) / (mu * mu * (mu * mu - 1.0));
      expected.push_back(25.0 / (4.0 * times[t]) * (1.0 - 8.0 * sum));
    }
    hold("cylinder 5: D(t) across at 1, 5, 10 ms", spread, expected);
    hold_kurtosis("cylinder 5: K_x in the limit", walks, 4, 50.0, 0, -0.5);
  }
  {
    Membranes m;
    add_plane(m, 1.0, 12.0, false), add_plane(m, 11.0, 12.0, true);
    const Walls walls(box, m, 0.12, workers, Progress());
    std::vector<Start> start;
    for (std::uint64_t i = 0; i < 500 * factor; i++) {
      conceg_rng rng = conceg_rng_stream(seed, "test.plane", i);
      start.push_back({{6.0, 6.0, 1.0 + 10.0 * conceg_rng_uniform(&rng)}, true, i});
    }
    std::vector<std::vector<double>> signal, spread;
    const std::vector<Walk> walks = go(walls, timeline, physics, start, workers);
    for (const Walk &w : walks) {
      std::vector<double> row;
      spread.emplace_back();
      for (std::size_t t = 0; t < 3; t++)
        spread.back().push_back(std::pow(w.displacement[t].z, 2) / (2.0 * times[t]));
      for (const std::size_t t : {2u, 4u})
        for (const double k : q)
          row.push_back(std::cos(k * w.displacement[t].z));
      signal.push_back(row);
    }
    // The limit at 50 ms is short of its last 4e-5.
    hold("planes 10: short pulses", signal,
         {0.74574556, 0.13532526, 0.04634914, 0.70807342, 0.05730703, 0.03579688});
    // D(t) = L^2 / (12 t) (1 - 96 / pi^4 sum over odd n of exp(-n^2 pi^2 D t / L^2) / n^4).
    std::vector<double> expected;
    for (std::size_t t = 0; t < 3; t++) {
      double sum = 0.0;
      for (int n = 1; n < 20; n += 2)
        sum += std::exp(-n * n * M_PI * M_PI * 2.0 * times[t] / 100.0) / std::pow(n, 4);
      expected.push_back(100.0 / (12.0 * times[t]) * (1.0 - 96.0 / std::pow(M_PI, 4) * sum));
    }
    hold("planes 10: D(t) across at 1, 5, 10 ms", spread, expected);
    hold_kurtosis("planes 10: K_z in the limit", walks, 4, 50.0, 2, -0.6);
  }
}

// D(t) / D0 = 1 - 4 / (9 sqrt pi) S/V sqrt(D0 t) + ... (Mitra et al. 1993). The way of the same draws without
// walls is known on average and takes most of the noise away.
void test_surface(Workers &workers) {
  const conceg_box box = cube(12.0);
  Membranes m;
  add_sphere(m, glm::dvec3(6.0), 5.0, 5);
  const Walls walls(box, m, 0.12, workers, Progress());
  Physics physics;
  physics.jumps = false, physics.step_ms = 2e-4;
  const std::vector<double> times = {0.01, 0.02, 0.05};
  const std::vector<double> exact = {0.97832330, 0, 0.95042905};
  const Timeline timeline = recorded(times);
  const std::vector<Start> start = starts_in_sphere(walls, glm::dvec3(6.0), 5.0, 160000 * factor);
  const std::vector<Walk> walks = go(walls, timeline, physics, start, workers);
  std::vector<std::vector<double>> sample;
  for (std::size_t i = 0; i < walks.size(); i++) {
    Directions directions(conceg_rng_stream(seed, "simulate.step", i));
    glm::dvec3 free(0.0);
    std::vector<double> row;
    double begin = 0.0;
    for (std::size_t t = 0; t < times.size(); t++) {
      const double steps = std::round((times[t] - begin) / 2e-4);
      for (int k = 0; k < static_cast<int>(steps); k++)
        free += std::sqrt(12.0 * 2e-4) * directions.next();
      begin = times[t];
      const double less = glm::dot(free, free) - glm::dot(walks[i].displacement[t], walks[i].displacement[t]);
      row.push_back(1.0 - less / (12.0 * times[t]));
    }
    sample.push_back({row[0], row[2], row[1]});
  }
  const Deviation d = deviation(sample, {exact[0], exact[2], 0.0});
  report("sphere 5: D(t) / D0 at 0.01 ms", d.mean[0], d.error[0], exact[0]);
  report("sphere 5: D(t) / D0 at 0.05 ms", d.mean[1], d.error[1], exact[2]);
  // With the next term, curvature (2 / R) D0 t / 12, of a ball: S/V from 0.05 ms.
  const double law = 4.0 / (9.0 * std::sqrt(M_PI)) * std::sqrt(2.0 * 0.05) + 2.0 / 5.0 / 12.0 * 2.0 * 0.05;
  const double ratio = (1.0 - d.mean[1]) / law;
  std::printf("  S/V by D(t): %.4f, of the sphere 0.6000\n", ratio);
  CHECK_NEAR(ratio, 0.6, 0.03 * 0.6);
}

// A sphere whose outside swallows: survival by the series of mu cot mu = 1 - kappa R / D.
void test_absorption(Workers &workers) {
  const conceg_box box = cube(12.0);
  Membranes m;
  add_sphere(m, glm::dvec3(6.0), 5.0, 4);
  const Walls walls(box, m, 0.12, workers, Progress());
  Physics physics;
  physics.permeability.assign(m.face.size(), 0.05), physics.absorb = true;
  const std::vector<double> times = {1.0, 5.0, 10.0, 25.0},
                            survival = {0.97095175, 0.86366806, 0.74611883, 0.48105144};
  std::vector<std::vector<double>> sample;
  for (const Walk &w : go(walls, recorded(times), physics,
                          starts_in_sphere(walls, glm::dvec3(6.0), 5.0, 3000 * factor), workers)) {
    std::vector<double> row;
    for (const double t : times)
      row.push_back(!w.absorbed || w.absorbed_ms > t ? 1.0 : 0.0);
    sample.push_back(row);
  }
  hold("absorbing sphere: survival at 1, 5, 10, 25 ms", sample, survival);
}

// Walkers spread evenly stay so, also where the media differ.
void test_balance(Workers &workers) {
  const conceg_box box = cube(9.0);
  Membranes m;
  add_sphere(m, glm::dvec3(4.5), 4.0, 4);
  for (const double outside : {2.0, 0.7}) {
    Physics physics;
    physics.extra.diffusivity = outside, physics.permeability.assign(m.face.size(), 0.2);
    const Walls walls(box, m, 0.12, workers, Progress());
    std::vector<Start> start;
    const double share = 4.0 / 3.0 * M_PI * 64.0 / 729.0;
    for (std::uint64_t i = 0; i < 3000 * factor; i++) {
      conceg_rng rng = conceg_rng_stream(seed, "test.balance", i);
      glm::dvec3 p;
      for (int axis = 0; axis < 3; axis++)
        p[axis] = 9.0 * conceg_rng_uniform(&rng);
      const double depth = 4.0 - glm::distance(p, glm::dvec3(4.5));
      bool inside = depth > 0.0;
      if (std::fabs(depth) < 0.02) { // facets lie a little off the ball: they decide
        inside = true;
        for (const glm::uvec3 &f : m.face)
          inside =
              inside && glm::dot(glm::cross(m.vertex[f.y] - m.vertex[f.x], m.vertex[f.z] - m.vertex[f.x]),
                                 p - m.vertex[f.x]) < 0.0;
      }
      start.push_back({p, inside, i});
    }
    double within = 0.0, wrong = 0.0;
    for (const Walk &w : go(walls, recorded({10.0}), physics, start, workers)) {
      within += w.inside;
      const double r = glm::distance(walls.position(w.place), glm::dvec3(4.5));
      wrong += std::fabs(r - 4.0) > 0.02 && (r < 4.0) != w.inside;
    }
    const double n = static_cast<double>(start.size());
    hold_one(outside == 2.0 ? "balance, D 2 and 2" : "balance, D 2 and 0.7", within / n,
             std::sqrt(share * (1.0 - share) / n), share);
    CHECK_EQUAL(wrong, 0);
  }
}

// Sheets of 0.7 um with D 0.1 between gaps of 0.3 um with D 1, gradients along them: free diffusion within
// each, and exchange that is slow beside the way across, so that the equations of Karger (1985) hold. Signals
// by their integration for a share of 0.7 and 0.05 exchanges per ms out of the sheets. From middle to middle
// an exchange passes the membrane and, on average, a sixth of each layer: R = 1 / kappa + a / 6 D + a' / 6
// D', rate = 2 / (a R).
void test_exchange(Workers &workers) {
  const double side = 2.0;
  Membranes m;
  for (const double z : {0.15, 1.15})
    add_plane(m, z, side, false), add_plane(m, z + 0.7, side, true);
  Physics physics;
  physics.intra.diffusivity = 0.1, physics.extra.diffusivity = 1.0, physics.step_ms = 5e-4;
  const double resistance = 2.0 / (0.7 * 0.05);
  physics.permeability.assign(m.face.size(), 1.0 / (resistance - 0.7 / 0.6 - 0.3 / 6.0));
  const Walls walls(cube(side), m, 1.01 * step_length(physics.extra, physics.step_ms), workers, Progress());
  const double b[] = {0.5, 1, 2, 3, 5, 10};
  std::vector<Pulses> rows;
  for (const double value : b)
    rows.push_back({value, {1, 0, 0}, 5, 20, 25, 0}), rows.push_back({value, {0, 1, 0}, 5, 20, 25, 0});
  const Protocol protocol = pulsed(rows);
  std::vector<Start> start;
  for (std::uint64_t i = 0; i < 2000 * factor; i++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.exchange", i);
    glm::dvec3 p;
    for (int axis = 0; axis < 3; axis++)
      p[axis] = side * conceg_rng_uniform(&rng);
    const double z = std::fmod(p.z, 1.0);
    start.push_back({p, z > 0.15 && z < 0.85, i});
  }
  std::vector<std::vector<double>> sample;
  for (const Walk &w : go(walls, protocol.timeline, physics, start, workers)) {
    std::vector<double> row;
    for (std::size_t r = 0; r < rows.size(); r += 2)
      row.push_back(0.5 * (std::cos(glm::dot(protocol.coefficient[r], w.vector[0])) +
                           std::cos(glm::dot(protocol.coefficient[r + 1], w.vector[0]))));
    sample.push_back(row);
  }
  hold("sheets, Karger exchange: S at b 0.5 .. 10", sample,
       {0.83868982, 0.71528667, 0.54253285, 0.42969117, 0.29325957, 0.14176369});
  // Without exchange it would be another signal.
  const Deviation apart =
      deviation(sample, {0.84781981, 0.74375005, 0.61371214, 0.53350890, 0.42659287, 0.25752926});
  CHECK(apart.z[4] < -4.5);
}

// Corners on the sphere: the error of coarse meshes falls as the square of the edge.
void test_refinement(Workers &workers) {
  const conceg_box box = cube(12.0);
  double difference[2];
  double error[2];
  const Protocol protocol = pulsed(
      {{3.0, {1, 0, 0}, 5, 20, 25, 0}, {3.0, {0, 1, 0}, 5, 20, 25, 0}, {3.0, {0, 0, 1}, 5, 20, 25, 0}});
  for (int rounds = 1; rounds <= 2; rounds++) {
    Membranes m;
    add_sphere(m, glm::dvec3(6.0), 5.0, rounds);
    double farthest = 0.0;
    for (const glm::dvec3 &v : m.vertex)
      farthest = std::max(farthest, glm::distance(v, glm::dvec3(6.0)));
    for (glm::dvec3 &v : m.vertex)
      v = glm::dvec3(6.0) + (v - glm::dvec3(6.0)) * (5.0 / farthest);
    const Walls walls(box, m, 0.12, workers, Progress());
    double inner =
        5.0; // the ball within all faces: walkers begin anywhere inside, by rejection with the faces
    for (const glm::uvec3 &f : m.face) {
      const glm::dvec3 n =
          glm::normalize(glm::cross(m.vertex[f.y] - m.vertex[f.x], m.vertex[f.z] - m.vertex[f.x]));
      inner = std::min(inner, glm::dot(n, m.vertex[f.x] - glm::dvec3(6.0)));
    }
    std::vector<Start> start;
    for (const Start &s : starts_in_sphere(walls, glm::dvec3(6.0), 5.0, 3000 * factor)) {
      bool inside = true;
      for (const glm::uvec3 &f : m.face)
        inside = inside && glm::dot(glm::cross(m.vertex[f.y] - m.vertex[f.x], m.vertex[f.z] - m.vertex[f.x]),
                                    s.place - m.vertex[f.x]) < -1e-6;
      if (inside) start.push_back(s);
    }
    std::vector<std::vector<double>> sample;
    for (const Walk &w : go(walls, protocol.timeline, Physics(), start, workers)) {
      double mean = 0.0;
      for (const glm::dvec3 &c : protocol.coefficient)
        mean += std::cos(glm::dot(c, w.vector[0])) / 3.0;
      sample.push_back({mean});
    }
    const Deviation d = deviation(sample, {0.60093273});
    difference[rounds - 1] = d.mean[0] - 0.60093273, error[rounds - 1] = d.error[0];
  }
  const double ratio = difference[0] / difference[1],
               spread = ratio * std::hypot(error[0] / difference[0], error[1] / difference[1]);
  std::printf(
      "  mesh of 80 and 320 faces: error %.4f (%.4f) and %.4f (%.4f), ratio %.2f (%.2f), 4 expected\n",
      difference[0], error[0], difference[1], error[1], ratio, spread);
  CHECK(difference[0] > 4.5 * error[0]);
  CHECK_NEAR(difference[1], difference[0] / 4.0, 4.5 * std::hypot(error[1], error[0] / 4.0));
}

} // namespace

int main(int argc, char **argv) {
  if (argc > 1) seed = std::strtoull(argv[1], nullptr, 10);
  if (argc > 2) factor = std::strtoull(argv[2], nullptr, 10);
  Workers workers(2);
  test_free(workers);
  test_displacements(workers);
  test_surface(workers);
  test_absorption(workers);
  test_balance(workers);
  test_exchange(workers);
  test_refinement(workers);
  std::printf("seed %llu: largest |z| %.2f; chi2 %.1f of %zu, p %.4f\n",
              static_cast<unsigned long long>(seed), worst, all.value, all.degrees, all.p());
  CHECK(worst <= 4.5);
  CHECK(all.p() > 0.001);
  return check_done();
}
