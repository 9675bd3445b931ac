// SPDX-License-Identifier: BSD-3-Clause
// Walkers in pores whose signals are known exactly. Every case is held against its values by its own
// covariance (Hotelling), all of them together by chi-square, and each value by its z score. The table is
// printed.  test_goldens [SEED WALKERS]
#include "goldens.hpp"
#include "shapes.hpp"
#include "statistics.hpp"

#include "../protocol.hpp"
#include "../seeds.hpp"

#include "check.h"

#include <functional>

using namespace conceg;
using namespace conceg::simulate;
using namespace conceg::simulate::testing;

namespace {

struct Case {
  double size = 0.0;
  conceg_box box;
  Membranes membranes;
  std::vector<glm::dvec3> axes;                         // of the gradient
  std::function<double(const glm::dvec3 &)> outside_um; // of the pore; negative within
};

Case make(const Golden &g) {
  Case c;
  const double side = g.pore == Pore::planes ? g.size + 2.0 : 2.0 * g.size + 1.0, middle = 0.5 * side;
  c.box = cube(side), c.size = g.size;
  const glm::dvec3 centre(middle);
  if (g.pore == Pore::sphere) {
    add_sphere(c.membranes, centre, g.size, 5);
    c.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    c.outside_um = [=](const glm::dvec3 &p) { return glm::distance(p, centre) - g.size; };
  } else if (g.pore == Pore::cylinder) {
    add_cylinder(c.membranes, middle, middle, g.size, side, 256);
    c.axes = {{1, 0, 0}, {0, 1, 0}};
    c.outside_um = [=](const glm::dvec3 &p) { return std::hypot(p.x - middle, p.y - middle) - g.size; };
  } else {
    add_plane(c.membranes, 1.0, side, false), add_plane(c.membranes, 1.0 + g.size, side, true);
    c.axes = {{0, 0, 1}};
    c.outside_um = [=](const glm::dvec3 &p) { return std::fabs(p.z - 1.0 - 0.5 * g.size) - 0.5 * g.size; };
  }
  return c;
}

std::vector<Start> starts(const Case &c, const Walls &walls, std::size_t count, std::uint64_t seed) {
  std::vector<Start> out;
  for (std::uint64_t i = 0; i < count; i++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.start", i);
    glm::dvec3 p;
    do {
      for (int axis = 0; axis < 3; axis++)
        p[axis] = conceg_box_side(&c.box, axis) * conceg_rng_uniform(&rng);
    } while (c.outside_um(p) > -0.002 * c.size);
    out.push_back({walls.local(p), true, i});
  }
  return out;
}

} // namespace

int main(int argc, char **argv) {
  const std::uint64_t seed = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1;
  const std::size_t asked = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1500;
  Workers workers(2);
  ChiSquare all;
  double worst = 0.0;
  std::uint64_t leaks = 0, steps = 0, retractions = 0;
  for (const Golden &g : goldens) {
    const Case c = make(g);
    // The approximation that must fail is 0.045 off there: seven standard errors.
    const bool telling = g.pore == Pore::sphere && g.size == 7 && g.diffusivity == 2;
    const std::size_t count = telling ? std::max<std::size_t>(asked, 4000) : asked;
    Physics physics;
    physics.intra.diffusivity = g.diffusivity;
    // A step must be short beside the pore.
    physics.step_ms = std::min(1e-3, g.size * g.size / 250.0 / g.diffusivity);
    const Walls walls(c.box, c.membranes, 1.01 * step_length(physics.intra, physics.step_ms), workers,
                      Progress());
    std::vector<Pulses> rows;
    for (const double b : golden_b)
      for (const glm::dvec3 &axis : c.axes)
        rows.push_back({b, axis, 5.0, 20.0, 25.0, 0});
    const Protocol protocol = pulsed(rows);
    const std::vector<Start> start = starts(c, walls, count, seed);
    std::vector<std::vector<double>> cosine(count,
                                            std::vector<double>(9)); // per walker and b, mean over axes
    std::vector<Tally> tally(workers.threads());
    std::vector<std::uint8_t> lost(count);
    workers.loop((count + 7) / 8, 1, [&](std::size_t block, unsigned worker) {
      const std::size_t begin = 8 * block, many = std::min<std::size_t>(8, count - begin);
      const std::vector<Walk> walks =
          walk(walls, protocol.timeline, physics, &start[begin], many, seed, tally[worker]);
      for (std::size_t i = 0; i < many; i++) {
        lost[begin + i] =
            c.outside_um(walls.position(walks[i].place)) > 0.002 * g.size; // facets reach a little out
        for (std::size_t r = 0; r < rows.size(); r++)
          cosine[begin + i][r / c.axes.size()] +=
              std::cos(glm::dot(protocol.coefficient[r], walks[i].vector[0])) /
              static_cast<double>(c.axes.size());
      }
    });
    for (const Tally &t : tally)
      steps += t.steps, retractions += t.retractions;
    for (const std::uint8_t l : lost)
      leaks += l;
    const Deviation d = deviation(cosine, std::vector<double>(g.signal, g.signal + 9));
    std::printf("%-14s", g.name);
    for (std::size_t k = 0; k < 9; k++) {
      std::printf(" %.5f(%.0e) %+5.2f", d.mean[k], d.error[k], d.z[k]);
      worst = std::max(worst, std::fabs(d.z[k]));
    }
    std::printf("  chi2 %.1f of %zu, p %.3f\n", d.chi2.value, d.chi2.degrees, d.chi2.p());
    all.add(d.chi2);
    if (telling) {
      CHECK(std::fabs(d.mean[4] - approximate_sphere_7[2]) > 4.5 * d.error[4]);
    }
  }
  std::printf("seed %llu, %zu walkers a case, %.3g steps: largest |z| %.2f, chi2 %.1f of %zu, p %.4f; leaks: "
              "%llu, retractions: %llu\n",
              static_cast<unsigned long long>(seed), asked, static_cast<double>(steps), worst, all.value,
              all.degrees, all.p(), static_cast<unsigned long long>(leaks),
              static_cast<unsigned long long>(retractions));
  CHECK(worst <= 4.5);
  CHECK(all.p() > 0.001);
  CHECK_EQUAL(leaks, 0);
  CHECK(static_cast<double>(retractions) < 1e-7 * static_cast<double>(steps));
  return check_done();
}
