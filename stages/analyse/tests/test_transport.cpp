// SPDX-License-Identifier: BSD-3-Clause
// Transport tortuosity of media whose D* is known.
#include "../transport.hpp"
#include "check.h"

#include <algorithm>
#include <cmath>

using namespace conceg;
using namespace conceg::analyse;

namespace {

constexpr double pi = 3.14159265358979323846;

template <class Open>
Transport solve(std::array<std::size_t, 3> shape, const Open &open, std::array<double, 3> spacing = {1, 1, 1},
                unsigned threads = 2, std::array<bool, 3> axes = {true, true, true}) {
  OpenVoxels voxels = {shape, {}, spacing};
  for (std::size_t x = 0; x < shape[0]; x++)
    for (std::size_t y = 0; y < shape[1]; y++)
      for (std::size_t z = 0; z < shape[2]; z++)
        voxels.open.push_back(open(x, y, z) ? 1 : 0);
  Workers workers(threads);
  return transport_of(voxels, axes, 1e-8, workers, {});
}

void empty_and_slabs() {
  const Transport empty = solve({6, 5, 4}, [](std::size_t, std::size_t, std::size_t) { return true; });
  CHECK_NEAR(empty.lambda(), 1, 1e-12);
  CHECK_EQUAL(empty.iterations[0], 0);
  const Transport slabs =
      solve({8, 6, 6}, [](std::size_t x, std::size_t, std::size_t) { return x % 4 != 0; });
  CHECK_NEAR(slabs.ratio[0], 0, 1e-9);
  CHECK_NEAR(slabs.ratio[1], 1, 1e-9);
  CHECK_NEAR(slabs.ratio[2], 1, 1e-9);
  CHECK_NEAR(slabs.open_fraction, 0.75, 1e-12);
  CHECK_NEAR(slabs.lambda(), std::sqrt(1.5), 1e-9); // 2/3 of D_0 in the mean, as of sheets in all directions
}

// A channel that steps aside, of voxels twice as long in z as in x: in series 4 voxels along z (2 um each,
// one voxel wide) and one step in x; the flux through it in closed form.
void bent_channel() {
  // Open: (0, z) for z 0..3 and (1, 3), then (1, z) wraps? A zigzag that closes on itself over the box:
  // rows z = 0, 1 at x = 0; z = 1, 2 at x = 1 ... joined in x at z = 1 and at z = 3 through x = 0 again.
  const auto open = [](std::size_t x, std::size_t, std::size_t z) {
    return (x == 0 && (z == 0 || z == 1 || z == 3)) || (x == 1 && (z == 1 || z == 2 || z == 3));
  };
  const Transport bent = solve({3, 1, 4}, open, {0.5, 1, 2});
  // Along z one loop of 4 steps of 2 um and 2 steps of 0.5 um, of conductances w_x w_y / h: 0.5 / 2 each, and
  // 2 / 0.5. Drive 8 um (unit slope over the box): current I = 8 / (4 * 2 / 0.5 + 2 * 0.5 / 2) with faces 0.5
  // and 2 wide.
  const double current = 8 / (4 * (2 / 0.5) + 2 * (0.5 / 2));
  // Mean flux over the open volume: I * 8 um / (6 voxels of 1 um3).
  CHECK_NEAR(bent.ratio[2], current * 8 / 6, 1e-9);
}

// Simple cubic lattice of spheres: Rayleigh's series, as voxels and extrapolated.
void spheres() {
  for (const double filled : {0.30, 0.45}) {
    const double radius = std::cbrt(3 * filled / (4 * pi));
    std::vector<double> found;
    for (const std::size_t n : {std::size_t(32), std::size_t(64)}) {
      const auto open = [&](std::size_t x, std::size_t y, std::size_t z) {
        const auto from = [&](std::size_t i) {
          return (static_cast<double>(i) + 0.5) / static_cast<double>(n) - 0.5;
        };
        return from(x) * from(x) + from(y) * from(y) + from(z) * from(z) > radius * radius;
      };
      const double h = 1 / static_cast<double>(n);
      found.push_back(solve({n, n, n}, open, {h, h, h}, 2, {true, false, false}).ratio[0]);
    }
    const double sigma = 1 + 3 * filled / (-2 - filled + 0.979 * std::pow(filled, 10.0 / 3));
    const double expected = sigma / (1 - filled), extrapolated = 2 * found[1] - found[0];
    printf("cubic spheres %.2f: %.4f, %.4f, extrapolated %.4f (%.4f)\n", filled, found[0], found[1],
           extrapolated, expected);
    CHECK_NEAR(extrapolated / expected, 1, 0.01);
    CHECK(found[1] > found[0] && found[1] < expected);
  }
}

// Square lattice of cylinders: 1 / (1 + filled) across, 1 along.
void cylinders() {
  const double filled = 0.2, radius = std::sqrt(filled / pi);
  std::vector<double> across;
  for (const std::size_t n : {std::size_t(64), std::size_t(128)}) {
    const auto open = [&](std::size_t x, std::size_t y, std::size_t) {
      const auto from = [&](std::size_t i) {
        return (static_cast<double>(i) + 0.5) / static_cast<double>(n) - 0.5;
      };
      return from(x) * from(x) + from(y) * from(y) > radius * radius;
    };
    const double h = 1 / static_cast<double>(n);
    const Transport t = solve({n, n, 2}, open, {h, h, h});
    CHECK_NEAR(t.ratio[2], 1, 1e-9);
    CHECK_NEAR(t.ratio[0], t.ratio[1], 1e-6);
    across.push_back(t.ratio[0]);
  }
  printf("cylinders: %.4f, %.4f (%.4f)\n", across[0], across[1], 1 / (1 + filled));
  CHECK_NEAR((2 * across[1] - across[0]) * (1 + filled), 1, 0.005);
}

// Half of the voxels, at random: pieces of all sizes and dead ends. Iterations must hardly grow with the box.
void random_voxels() {
  std::vector<int> iterations;
  for (const std::size_t n : {std::size_t(24), std::size_t(96)}) {
    const auto open = [](std::size_t x, std::size_t y, std::size_t z) {
      std::uint64_t h = x * 73856093u ^ y * 19349663u ^ z * 83492791u;
      h ^= h >> 13, h *= 0x9E3779B97F4A7C15u, h ^= h >> 29;
      return h % 2 == 0;
    };
    iterations.push_back(solve({n, n, n}, open, {1, 1, 1}, 2, {true, false, false}).iterations[0]);
  }
  printf("half of the voxels at random: %d iterations in 24^3, %d in 96^3\n", iterations[0], iterations[1]);
  CHECK(iterations[1] <= 1.5 * iterations[0]); // plain conjugate gradients take four times as many
}

void threads() {
  const auto open = [](std::size_t x, std::size_t y, std::size_t z) {
    return (x * 7 + y * 3 + z * 5) % 11 > 3;
  };
  const Transport one = solve({60, 54, 48}, open, {1, 1, 1}, 1),
                  three = solve({60, 54, 48}, open, {1, 1, 1}, 3);
  CHECK(one.ratio == three.ratio);
  CHECK(one.lambda() > 1);
}

} // namespace

int main() {
  empty_and_slabs();
  bent_channel();
  spheres();
  cylinders();
  random_voxels();
  threads();
  return check_done();
}
