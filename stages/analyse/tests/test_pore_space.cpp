// SPDX-License-Identifier: BSD-3-Clause
// Pore sizes of media whose sizes are known, by all definitions.
#include "../pore_space.hpp"
#include "check.h"
#include "conceg/rng.h"

#include <algorithm>
#include <cmath>

using namespace conceg;
using namespace conceg::analyse;

namespace {

constexpr double pi = 3.14159265358979323846;

template <class Open> OpenVoxels medium(std::array<std::size_t, 3> shape, double h, const Open &open) {
  OpenVoxels v = {shape, {}, {h, h, h}};
  for (std::size_t x = 0; x < shape[0]; x++)
    for (std::size_t y = 0; y < shape[1]; y++)
      for (std::size_t z = 0; z < shape[2]; z++)
        v.open.push_back(open((static_cast<double>(x) + 0.5) * h, (static_cast<double>(y) + 0.5) * h,
                              (static_cast<double>(z) + 0.5) * h)
                             ? 1
                             : 0);
  return v;
}

PoreSpace sizes(const OpenVoxels &v, unsigned threads = 2) {
  Workers workers(threads);
  return pore_space(std::vector<OpenVoxels>{v}, workers);
}

// Distance in a box of the given side, over its faces.
double wrapped(double d, double side) {
  return d - side * std::round(d / side);
}

void slabs() {
  constexpr double h = 0.1, gap = 0.9, side = 3; // walls of 0.6
  const PoreSpace s =
      sizes(medium({30, 30, 30}, h, [&](double x, double, double) { return std::fmod(x, 1.5) < gap; }));
  CHECK_NEAR(s.centres.mean, gap / 2, h / 2);
  CHECK_EQUAL(s.centres.count, 2u); // one maximum in each gap: its plateau counts once
  CHECK_NEAR(s.voxels.mean, gap / 4, h / 2);
  CHECK_NEAR(s.thickness.mean, gap / 2, h / 2);
  CHECK(s.thickness.sd < 1e-6);
  CHECK_NEAR(s.gaps.mean, gap, h);
  CHECK_NEAR(s.chords.mean, gap, 1e-9); // along x; the other lines have no end
  CHECK_EQUAL(s.chords.count, static_cast<std::uint64_t>(2 * 30 * 30));
  (void)side;
}

void lattices() {
  constexpr double h = 0.05, side = 2, radius = 0.7;
  const PoreSpace balls = sizes(medium({40, 40, 40}, h, [&](double x, double y, double z) {
    const double a = wrapped(x, side), b = wrapped(y, side), c = wrapped(z, side);
    return a * a + b * b + c * c > radius * radius;
  }));
  CHECK_EQUAL(balls.centres.count, 1u);
  CHECK_NEAR(balls.centres.mean, std::sqrt(3.0) / 2 * side - radius, h);
  const OpenVoxels rods = medium({40, 40, 8}, h, [&](double x, double y, double) {
    const double a = wrapped(x, side), b = wrapped(y, side);
    return a * a + b * b > radius * radius;
  });
  const PoreSpace discs = sizes(section(rods, 2, 3));
  CHECK_EQUAL(discs.centres.count, 1u);
  CHECK_NEAR(discs.centres.mean, side / std::sqrt(2.0) - radius, h);
  CHECK_NEAR(sizes(rods).centres.mean, discs.centres.mean, 1e-6);
}

// Boolean model of balls: P(distance > r | open) = exp(-density 4 pi / 3 ((R + r)^3 - R^3)).
void boolean_model() {
  constexpr double h = 0.25, side = 30, ball = 2, density = 0.02;
  conceg_rng rng = conceg_rng_stream(1, "test.pores", 0);
  std::vector<std::array<double, 3>> centre(static_cast<std::size_t>(density * side * side * side));
  for (auto &c : centre)
    for (double &v : c)
      v = side * conceg_rng_uniform(&rng);
  OpenVoxels v = medium({120, 120, 120}, h, [](double, double, double) { return true; });
  for (const auto &c : centre)
    for (int x = -9; x <= 9; x++)
      for (int y = -9; y <= 9; y++)
        for (int z = -9; z <= 9; z++) {
          std::size_t at[3];
          double squared = 0;
          const int d[3] = {x, y, z};
          for (std::size_t a = 0; a < 3; a++) {
            const int i = static_cast<int>(std::floor(c[a] / h)) + d[a];
            const double away = (i + 0.5) * h - c[a];
            squared += away * away, at[a] = static_cast<std::size_t>((i + 120) % 120);
          }
          if (squared < ball * ball) v.open[(at[0] * 120 + at[1]) * 120 + at[2]] = 0;
        }
  double expected = 0; // integral of P over r
  for (double r = 0.0005; r < 6; r += 0.001)
    expected += 0.001 * std::exp(-density * 4 * pi / 3 * (std::pow(ball + r, 3) - std::pow(ball, 3)));
  const PoreSpace space = sizes(v);
  double flat = 0;
  for (std::size_t z = 0; z < 120; z += 8)
    flat += sizes(section(v, 2, z)).voxels.mean / 15;
  printf("Boolean balls: mean distance %.3f (%.3f), in sections %.2f times\n", space.voxels.mean, expected,
         flat / space.voxels.mean);
  CHECK_NEAR(space.voxels.mean, expected, 0.06);
  CHECK_NEAR(flat / space.voxels.mean, 1.44, 0.1);
  CHECK(space.thickness.mean > space.voxels.mean && space.centres.count > 50);
}

// The transform against all pairs.
void radii_are_distances() {
  conceg_rng rng = conceg_rng_stream(2, "test.pores", 0);
  OpenVoxels v = {{9, 7, 11}, {}, {1, 1.5, 0.5}};
  for (int i = 0; i < 9 * 7 * 11; i++)
    v.open.push_back(conceg_rng_uniform(&rng) < 0.97);
  Workers workers(2);
  const std::vector<float> radius = pore_radii(v, workers);
  const double half = 0.5 * std::cbrt(0.75);
  double worst = 0;
  for (std::size_t i = 0; i < v.open.size(); i++) {
    if (!v.open[i]) continue;
    double nearest = 1e9;
    for (std::size_t j = 0; j < v.open.size(); j++) {
      if (v.open[j]) continue;
      double squared = 0;
      const std::size_t p[3] = {i / 77, i / 11 % 7, i % 11}, q[3] = {j / 77, j / 11 % 7, j % 11};
      for (std::size_t a = 0; a < 3; a++) {
        const double side = v.spacing[a] * static_cast<double>(v.shape[a]);
        const double d =
            wrapped((static_cast<double>(p[a]) - static_cast<double>(q[a])) * v.spacing[a], side);
        squared += d * d;
      }
      nearest = std::min(nearest, std::sqrt(squared));
    }
    worst = std::max(worst, std::abs(nearest - half - static_cast<double>(radius[i])));
  }
  CHECK(worst < 1e-5);
}

void bounds() {
  const PoreSpace empty = sizes(medium({4, 4, 4}, 1, [](double, double, double) { return true; }));
  CHECK(empty.voxels.mean == 0 && empty.chords.count == 0);
  const PoreSpace full = sizes(medium({4, 4, 4}, 1, [](double, double, double) { return false; }));
  CHECK(full.voxels.count == 0 && full.centres.count == 0);
}

} // namespace

int main() {
  slabs();
  lattices();
  boolean_model();
  radii_are_distances();
  bounds();
  return check_done();
}
