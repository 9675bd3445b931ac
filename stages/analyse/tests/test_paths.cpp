// SPDX-License-Identifier: BSD-3-Clause
// Path lengths through voxels: empty space, walls, a spiral, and what steps on a grid make of straight lines.
#include "../paths.hpp"
#include "check.h"

#include <algorithm>
#include <cmath>

using namespace conceg;
using namespace conceg::analyse;

namespace {

constexpr double pi = 3.14159265358979323846;

OpenVoxels empty(std::array<std::size_t, 3> shape, double h = 1) {
  return {shape, std::vector<std::uint8_t>(shape[0] * shape[1] * shape[2], 1), {h, h, h}};
}

std::size_t place(const OpenVoxels &v, std::size_t x, std::size_t y, std::size_t z) {
  return (x * v.shape[1] + y) * v.shape[2] + z;
}

PathStraightness straightness(const OpenVoxels &v, double least, unsigned threads = 2) {
  PathSettings settings;
  settings.least = least, settings.ends = 200;
  Workers workers(threads);
  return path_straightness({v}, settings, workers, {});
}

void empty_space() {
  const PathStraightness space = straightness(empty({48, 48, 48}), 12),
                         plane = straightness(empty({96, 96, 1}), 24);
  printf("empty space: marched %.4f and %.4f, stepped %.3f (0.920) and %.3f (0.949)\n", space.marched.mean,
         plane.marched.mean, space.stepped.mean, plane.stepped.mean);
  CHECK(space.marched.mean > 0.995 && plane.marched.mean > 0.995);
  CHECK_EQUAL(space.pairs, static_cast<std::uint64_t>(16 * 200));
  CHECK_EQUAL(space.apart, 0u);
  CHECK_NEAR(plane.stepped.mean, 0.949, 0.01);
}

// Mean over directions of straight line over steps, known for each set of neighbours; and the worst
// direction.
void steps_in_empty_space() {
  const struct {
    int neighbours;
    double mean, worst;
  } known[] = {{6, 0.674, 0.577}, {18, 0.887, 0.816}, {26, 0.920, 0.886}};
  const OpenVoxels v = empty({61, 61, 61});
  const std::size_t start = place(v, 30, 30, 30);
  for (const auto &k : known) {
    const std::vector<float> length = stepped_lengths(v, start, k.neighbours);
    double sum = 0, count = 0, worst = 1;
    for (int x = -30; x <= 30; x++)
      for (int y = -30; y <= 30; y++)
        for (int z = -30; z <= 30; z++) {
          const double euclid = std::sqrt(static_cast<double>(x * x + y * y + z * z));
          if (euclid < 20 || euclid > 30) continue; // a shell: all directions alike
          const double ratio =
              euclid / static_cast<double>(
                           length[place(v, static_cast<std::size_t>(30 + x), static_cast<std::size_t>(30 + y),
                                        static_cast<std::size_t>(30 + z))]);
          sum += ratio, count++, worst = std::min(worst, ratio);
        }
    CHECK_NEAR(sum / count, k.mean, 0.002);
    CHECK_NEAR(worst, k.worst, 0.01); // an odd number of diagonal halves takes a step more
  }
}

// A wall with an end to go round: two straight pieces meet at its edge.
void round_a_wall() {
  OpenVoxels v = empty({120, 120, 1}, 0.5);
  for (std::size_t y = 0; y < 120; y++)
    v.open[place(v, 0, y, 0)] = 0; // closes the box in x
  for (std::size_t x = 0; x < 120; x++)
    v.open[place(v, x, 0, 0)] = 0; // and in y
  for (std::size_t x = 60; x < 120; x++)
    v.open[place(v, x, 60, 0)] = 0; // from the middle to the far side
  const std::vector<float> length = marched_lengths(v, place(v, 100, 40, 0));
  // Round the last open centres at x = 59: from (100, 40) to (100, 80), units of 0.5 um.
  const double expected = 0.5 * 2 * std::hypot(100 - 59, 20);
  CHECK_NEAR(static_cast<double>(length[place(v, 100, 80, 0)]) / expected, 1, 0.015);
  CHECK(static_cast<double>(length[place(v, 100, 80, 0)]) > 0.5 * 60);
}

// Sealed off: no path, and it is counted.
void apart() {
  OpenVoxels v = empty({40, 40, 1});
  for (std::size_t y = 0; y < 40; y++)
    v.open[place(v, 0, y, 0)] = v.open[place(v, 20, y, 0)] = 0;
  const std::vector<float> length = marched_lengths(v, place(v, 10, 10, 0));
  CHECK(std::isinf(length[place(v, 30, 10, 0)]) && std::isinf(length[place(v, 20, 10, 0)]));
  CHECK(std::isinf(stepped_lengths(v, place(v, 10, 10, 0), 26)[place(v, 30, 10, 0)]));
  const PathStraightness s = straightness(v, 5);
  CHECK(s.apart > s.pairs / 4 && s.apart < s.pairs);
  CHECK_EQUAL(s.marched.count, s.pairs - s.apart);
  CHECK_EQUAL(straightness(v, 25).pairs, 0u); // farther than half of the box
}

// No step between two closed voxels that touch at a corner.
void no_corner_is_cut() {
  OpenVoxels v = empty({6, 6, 1});
  std::fill(v.open.begin(), v.open.end(), std::uint8_t{0});
  v.open[place(v, 2, 2, 0)] = v.open[place(v, 3, 3, 0)] = 1;
  CHECK(std::isinf(stepped_lengths(v, place(v, 2, 2, 0), 26)[place(v, 3, 3, 0)]));
  CHECK(std::isinf(marched_lengths(v, place(v, 2, 2, 0))[place(v, 3, 3, 0)]));
}

// An arc of a quarter circle, 5 voxels wide: the path hugs its inner side.
void arc() {
  OpenVoxels v = empty({100, 100, 1});
  for (std::size_t x = 0; x < 100; x++)
    for (std::size_t y = 0; y < 100; y++) {
      const double r = std::hypot(static_cast<double>(x), static_cast<double>(y));
      v.open[place(v, x, y, 0)] = r >= 70 && r < 75;
    }
  const std::vector<float> length = marched_lengths(v, place(v, 72, 0, 0));
  const double inner = 70 * pi / 2;
  CHECK_NEAR(static_cast<double>(length[place(v, 0, 72, 0)]) / inner, 1, 0.03);
}

// Shifting a periodic medium shifts the lengths.
void shifted() {
  OpenVoxels v = empty({24, 20, 16}), w = v;
  for (std::size_t x = 0; x < 24; x++)
    for (std::size_t y = 0; y < 20; y++)
      for (std::size_t z = 0; z < 16; z++) {
        const bool open = (x * 7 + y * 5 + z * 3) % 9 > 2;
        v.open[place(v, x, y, z)] = open, w.open[place(w, (x + 11) % 24, (y + 7) % 20, (z + 13) % 16)] = open;
      }
  std::size_t start = 0;
  while (!v.open[start])
    start++;
  const std::size_t x = start / 320, y = start / 16 % 20, z = start % 16;
  const std::vector<float> one = marched_lengths(v, start),
                           other = marched_lengths(w, place(w, (x + 11) % 24, (y + 7) % 20, (z + 13) % 16));
  float worst = 0;
  for (std::size_t i = 0; i < v.open.size(); i++) {
    const float moved = other[place(w, (i / 320 + 11) % 24, (i / 16 % 20 + 7) % 20, (i % 16 + 13) % 16)];
    if (v.open[i] && (one[i] < 1e9f || moved < 1e9f)) worst = std::max(worst, std::abs(one[i] - moved));
  }
  CHECK(worst < 1e-3f);
  const PathStraightness a = straightness(v, 6, 1), b = straightness(v, 6, 3);
  CHECK(a.marched.mean == b.marched.mean && a.stepped.p95 == b.stepped.p95);
}

} // namespace

int main() {
  empty_space();
  steps_in_empty_space();
  round_a_wall();
  apart();
  no_corner_is_cut();
  arc();
  shifted();
  return check_done();
}
