// SPDX-License-Identifier: BSD-3-Clause
// Passing axons as drawn: the cable that was asked, evenly over the box and all directions, open sides
// included; starts outside somas; streams of their own; wrong laws.
#include "../axons.hpp"

#include "check.h"
#include "wrap.hpp"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstdio>
#include <string>

using namespace conceg;
using namespace conceg::place;

static conceg_box make_box(double x, double y, double z, bool periodic_xy, bool periodic_z) {
  conceg_box box = {};
  box.hi[0] = x, box.hi[1] = y, box.hi[2] = z;
  box.periodic[0] = box.periodic[1] = periodic_xy, box.periodic[2] = periodic_z;
  return box;
}

static std::vector<Axon> draw(const conceg_box &box, const AxonLaw &law, const Somas &somas = {},
                              std::uint64_t seed = 1) {
  return draw_axons(box, law, somas, 2, 5, seed, "types[2]", nullptr);
}

static double cable(const std::vector<Axon> &axons) {
  double sum = 0.0;
  for (const Axon &axon : axons)
    sum += axon.length;
  return sum;
}

static void check_density() {
  const conceg_box box = make_box(40, 40, 40, true, true);
  for (const double density : {0.35, 1.0}) {
    AxonLaw law;
    law.cable_density = density;
    const std::vector<Axon> axons = draw(box, law);
    CHECK_NEAR(cable(axons) / volume(box), density, 1.0 / volume(box)); // less than 1 um is left out
    CHECK_EQUAL(axons.size(), std::ceil(density * 1600.0 - 1e-9));      // 40 um each
    for (std::size_t i = 0; i < axons.size(); i++) {
      CHECK_EQUAL(axons[i].id, 2 + 5 * i);
      if (i + 1 < axons.size()) CHECK_NEAR(axons[i].length, 40.0, 0.0);
      CHECK(axons[i].radius >= 0.25);
      for (int a = 0; a < 3; a++) {
        CHECK(axons[i].start[a] >= 0.0 && axons[i].start[a] < 40.0);
        CHECK(axons[i].start[a] == conceg_snap(axons[i].start[a]));
      }
    }
  }
  CHECK_NEAR(default_length(make_box(30, 50, 20, true, false)), 30.0, 0.0); // the open side does not count
  CHECK_NEAR(default_length(make_box(30, 40, 120, false, false)), 130.0, 1e-12);
}

// Cable in ten equal slices across z, relative to the mean; and the mean square cosine of all of it to z.
struct Spread {
  double least = 1e9, most = 0.0, square = 0.0;
};
static Spread spread_of(const conceg_box &box, const std::vector<Axon> &axons) {
  double slice[10] = {}, sum = 0.0;
  bool inside = true;
  Spread out;
  for (const Axon &axon : axons) {
    const double step = 0.1;
    for (double at = 0.5 * step; at < axon.length; at += step) {
      glm::dvec3 place = axon.start + at * axon.direction;
      for (int a = 0; a < 3; a++)
        inside &= box.periodic[a] || (place[a] >= box.lo[a] - 1e-3 && place[a] <= box.hi[a] + 1e-3);
      place = wrap(box, place);
      const int k = static_cast<int>(10.0 * (place.z - box.lo[2]) / conceg_box_side(&box, 2));
      slice[std::clamp(k, 0, 9)] += step, sum += step;
      out.square += step * axon.direction.z * axon.direction.z;
    }
  }
  CHECK(inside);
  for (const double part : slice)
    out.least = std::min(out.least, 10.0 * part / sum), out.most = std::max(out.most, 10.0 * part / sum);
  out.square /= sum;
  return out;
}

static void check_evenness() {
  AxonLaw law;
  for (const bool open : {false, true})
    for (const double length : {20.0, 150.0}) {
      const conceg_box box = make_box(60, 60, 40, !open, !open);
      law.cable_density = 1.0, law.length = length, law.direction.kappa = 0.0;
      const Spread even = spread_of(box, draw(box, law));
      std::printf("%s box, %g um: slices %.3f to %.3f, <cos2> %.3f\n", open ? "open" : "periodic", length,
                  even.least, even.most, even.square);
      // Of 144 mm in pieces of 20 to 150 um: a slice of 14.4 mm is off by 4 % or less (1 SE).
      CHECK(even.least > 0.88 && even.most < 1.12);
      CHECK_NEAR(even.square, 1.0 / 3.0, 0.03);
      law.direction.kappa = 10.0;
      CHECK_NEAR(spread_of(box, draw(box, law)).square, 0.8927, 0.02); // law: test_laws
    }
  // Starts in the box alone would leave less cable at open ends: the measure sees that.
  const conceg_box box = make_box(60, 60, 40, true, false);
  std::vector<Axon> thin;
  for (std::uint64_t i = 0; i < 2000; i++) {
    conceg_rng rng = conceg_rng_stream(9, "test", i);
    Axon axon = {};
    axon.start = {60 * conceg_rng_uniform(&rng), 60 * conceg_rng_uniform(&rng),
                  40 * conceg_rng_uniform(&rng)};
    axon.direction = draw_direction(AxonLaw().direction, rng);
    const double room = axon.direction.z > 0 ? 40 - axon.start.z : axon.start.z;
    axon.length = std::min(10.0, room / std::fabs(axon.direction.z));
    thin.push_back(axon);
  }
  CHECK(spread_of(box, thin).least < 0.88);
}

static void check_somas() {
  const conceg_box box = make_box(30, 30, 30, true, true);
  const Somas somas = {{{15, 15, 15}, {1, 1, 1}}, {8.0, 5.0}};
  const std::vector<Axon> with = draw(box, {}, somas), without = draw(box, {});
  std::size_t same = 0, inside = 0;
  for (std::size_t i = 0; i < with.size(); i++) {
    for (std::size_t s = 0; s < 2; s++) {
      CHECK(glm::length(nearest(box, with[i].start - somas.center[s])) >=
            somas.radius[s] + with[i].radius - 1e-4);
      inside += glm::length(nearest(box, without[i].start - somas.center[s])) < somas.radius[s];
    }
    same += with[i].start == without[i].start;
  }
  CHECK(inside > 20);
  CHECK(same + inside + 15 > with.size() && same < with.size()); // only those that stood in a soma moved
}

static void check_streams() {
  const conceg_box box = make_box(30, 30, 30, true, true);
  AxonLaw few, many;
  few.cable_density = 0.1;
  const std::vector<Axon> a = draw(box, few), b = draw(box, many), other = draw(box, many, {}, 2);
  CHECK(a.size() < b.size());
  for (std::size_t i = 0; i + 1 < a.size(); i++)
    CHECK(a[i].start == b[i].start && a[i].direction == b[i].direction && a[i].radius == b[i].radius);
  CHECK(other[0].start != b[0].start);
  Bars bars;
  append_axon(b[3], 0.15, bars);
  CHECK(bars.cell_offset == (std::vector<std::uint64_t>{0, 1}));
  CHECK(bars.parent[0] == -1 && bars.neurite[0] == 2 && bars.start[0] == 0.0 && bars.taper[0] == 0.0);
  CHECK_NEAR(bars.end[0], 30.0, 0.0);
  CHECK_NEAR(glm::distance(bars.attractor[0], b[3].start + 30.0 * b[3].direction), 0.0, 1e-12);
  CHECK_NEAR(bars.radius[0], b[3].radius, 0.0);
}

static void refused(const conceg_box &box, const AxonLaw &law, const Somas &somas, const char *expected) {
  std::string line;
  try {
    draw(box, law, somas);
  } catch (const Error &error) {
    line = error.what();
  }
  CHECK(line.find(expected) != std::string::npos);
  if (line.find(expected) == std::string::npos)
    std::fprintf(stderr, "expected \"%s\" in \"%s\"\n", expected, line.c_str());
}

int main() {
  check_density();
  check_evenness();
  check_somas();
  check_streams();
  const conceg_box box = make_box(20, 20, 20, true, true);
  AxonLaw law;
  law.length = 4.0;
  refused(box, law, {}, "types[2].length_um: expected 5 to 100000 um, got 4");
  law = {}, law.radius.minimum = 0.4;
  refused(box, law, {}, "types[2].radius_um.minimum: expected more than 0 and at most the mean");
  law = {}, law.radius.sd = 0.4;
  refused(box, law, {}, "types[2].radius_um.sd: expected 0 to the mean");
  law = {}, law.radius = {6.0, 0.0, 1.0};
  refused(box, law, {}, "expected radii below a quarter of the box's shortest side, 5 um, got one of 6 um");
  refused(box, {}, {{{10, 10, 10}}, {18.0}}, "no place outside the somas");
  law = {}, law.length = 100.0;
  refused(make_box(1e6, 1e6, 1e6, true, true), law, {}, "fewer than 1e+08 axons");
  return check_done();
}
