// SPDX-License-Identifier: BSD-3-Clause
// Composition scaling on media whose exponent is known, and the largest piece against a flood of voxels.
#include "../composition.hpp"
#include "check.h"
#include "conceg/rng.h"

#include <cmath>

using namespace conceg;
using namespace conceg::analyse;

namespace {

using Shape = std::array<std::uint32_t, 3>;

CompositionSettings settings_of(double smallest, double largest, int cubes = 60) {
  CompositionSettings s;
  s.smallest = smallest, s.largest = largest, s.cubes = cubes;
  return s;
}

template <class Label>
Composition measure(std::uint32_t size, const CompositionSettings &s, const Label &label) {
  Workers workers(2);
  const LabelRuns runs({size, size, size}, label, workers);
  return composition_of(runs, glm::dvec3(1), {true, true, true}, s, workers, {});
}

void solid_slabs_and_rods() {
  const auto solid =
      measure(96, settings_of(4, 64), [](std::uint32_t, std::uint32_t, std::uint32_t) { return 1u; });
  CHECK_NEAR(solid.all.fragment, 3, 1e-9);
  CHECK_NEAR(solid.all.cell, 3, 1e-9);
  // Slabs of 2 in every 4 voxels, each a cell; cubes from two spacings on.
  const auto slabs = measure(96, settings_of(8, 64), [](std::uint32_t x, std::uint32_t, std::uint32_t) {
    return x % 4 < 2 ? 1 + x / 4 : 0u;
  });
  CHECK_NEAR(slabs.all.fragment, 2, 1e-9);
  const auto rods = measure(96, settings_of(8, 64), [](std::uint32_t x, std::uint32_t y, std::uint32_t) {
    return x % 4 < 2 && y % 4 < 2 ? 1 + x / 4 + 100 * (y / 4) : 0u;
  });
  CHECK_NEAR(rods.all.fragment, 1, 1e-9);
  CHECK_NEAR(rods.rows[2].fragment_slope, 1, 1e-9);
  CHECK(rods.all.rows >= 8);
  CHECK(rods.all.fragment_error < 1e-6);
}

// Aligned cubes of two fractals: the largest piece is exactly 7^k and 20^k voxels.
void fractals() {
  Workers workers(2);
  const auto middle = [](std::uint32_t v) { return v % 3 == 1; };
  const auto vicsek = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    for (int k = 0; k < 4; k++, x /= 3, y /= 3, z /= 3)
      if (middle(x) + middle(y) + middle(z) < 2) return 0u;
    return 1u;
  };
  const auto menger = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    for (int k = 0; k < 4; k++, x /= 3, y /= 3, z /= 3)
      if (middle(x) + middle(y) + middle(z) >= 2) return 0u;
    return 1u;
  };
  const LabelRuns v({81, 81, 81}, vicsek, workers), m({81, 81, 81}, menger, workers);
  std::vector<double> side, of_vicsek, of_menger;
  for (std::uint32_t n = 3; n <= 81; n *= 3) {
    side.push_back(n);
    const std::uint32_t corner = (81 - n) / 2; // Vicsek: about the middle, Menger: a corner
    of_vicsek.push_back(static_cast<double>(largest_piece(v, {corner, corner, corner}, {n, n, n}).fragment));
    of_menger.push_back(static_cast<double>(largest_piece(m, {0, 0, 0}, {n, n, n}).fragment));
  }
  CHECK_NEAR(log_slope(side, of_vicsek), std::log(7.0) / std::log(3.0), 1e-9);
  CHECK_NEAR(log_slope(side, of_menger), std::log(20.0) / std::log(3.0), 1e-9);
}

// Site percolation on the cubic lattice at its threshold of 0.3116. The largest cluster's exponent is 2.52 in
// the limit; between 12 and 72 sites scipy.ndimage.label gives 2.43 +- 0.02 (cubes of their own, 80 to 2000
// of each of the sides 12 17 24 34 50 72). Sites are every second voxel, and the voxel between two of them is
// filled when both are, so that neighbours are by faces alone. One medium's largest clusters spread by a
// fifth, so means over media that are drawn anew.
void percolation() {
  constexpr std::uint32_t size = 144;
  constexpr std::uint64_t media = 16;
  double fragment = 0, cell = 0;
  for (std::uint64_t medium = 0; medium < media; medium++) {
    std::vector<std::uint8_t> site(size / 2 * size / 2 * size / 2);
    conceg_rng rng = conceg_rng_stream(medium, "test.percolation", 0);
    for (std::uint8_t &filled : site)
      filled = conceg_rng_uniform(&rng) < 0.3116;
    const auto at = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
      const std::uint32_t n = size / 2;
      return site[((x / 2) % n * n + (y / 2) % n) * n + (z / 2) % n] != 0;
    };
    const auto found =
        measure(size, settings_of(24, size, 8), [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
          if (x % 2 + y % 2 + z % 2 > 1) return 0u;
          return at(x, y, z) && at(x + x % 2, y + y % 2, z + z % 2) ? 1u : 0u;
        });
    fragment += found.all.fragment / media, cell += found.all.cell / media;
  }
  printf("percolation: %.3f (2.43)\n", fragment);
  CHECK_NEAR(fragment, 2.43, 0.08);
  CHECK_NEAR(cell, 3, 0.02); // all voxels of the label, connected or not
}

// Largest piece by flooding voxel after voxel.
std::uint64_t flooded(const std::vector<std::uint32_t> &label, const Shape &whole, const Shape &corner,
                      const Shape &side) {
  const auto at = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return label[((corner[0] + x) % whole[0] * static_cast<std::size_t>(whole[1]) +
                  (corner[1] + y) % whole[1]) *
                     whole[2] +
                 (corner[2] + z) % whole[2]];
  };
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(side[0]) * side[1] * side[2], 0);
  const auto place = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (static_cast<std::size_t>(x) * side[1] + y) * side[2] + z;
  };
  std::uint64_t largest = 0;
  for (std::uint32_t x = 0; x < side[0]; x++)
    for (std::uint32_t y = 0; y < side[1]; y++)
      for (std::uint32_t z = 0; z < side[2]; z++) {
        if (seen[place(x, y, z)] || !at(x, y, z)) continue;
        std::vector<Shape> open = {{x, y, z}};
        seen[place(x, y, z)] = 1;
        std::uint64_t count = 0;
        while (!open.empty()) {
          const Shape p = open.back();
          open.pop_back(), count++;
          for (int n = 0; n < 27; n++) {
            const std::uint32_t qx = p[0] + static_cast<std::uint32_t>(n / 9) - 1,
                                qy = p[1] + static_cast<std::uint32_t>(n / 3 % 3) - 1,
                                qz = p[2] + static_cast<std::uint32_t>(n % 3) - 1;
            if (qx >= side[0] || qy >= side[1] || qz >= side[2]) continue;
            if (seen[place(qx, qy, qz)] || at(qx, qy, qz) != at(p[0], p[1], p[2])) continue;
            seen[place(qx, qy, qz)] = 1, open.push_back({qx, qy, qz});
          }
        }
        largest = std::max(largest, count);
      }
  return largest;
}

void against_a_flood() {
  const Shape whole = {14, 11, 17};
  for (std::uint64_t seed = 0; seed < 40; seed++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.composition", 0);
    const double filled = 0.1 + 0.6 * conceg_rng_uniform(&rng);
    std::vector<std::uint32_t> label;
    for (std::size_t i = 0; i < 14 * 11 * 17; i++)
      label.push_back(
          conceg_rng_uniform(&rng) < filled ? 1 + static_cast<std::uint32_t>(conceg_rng_below(&rng, 3)) : 0);
    Workers workers(1);
    const LabelRuns runs(
        whole,
        [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return label[(x * 11 + y) * 17 + z]; },
        workers);
    Shape corner, side;
    for (std::size_t a = 0; a < 3; a++)
      corner[a] = static_cast<std::uint32_t>(conceg_rng_below(&rng, whole[a])),
      side[a] = 1 + static_cast<std::uint32_t>(conceg_rng_below(&rng, whole[a]));
    CHECK_EQUAL(largest_piece(runs, corner, side).fragment, flooded(label, whole, corner, side));
  }
}

void threads_and_bad_input() {
  const auto label = [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (x / 5 + y / 3 + z / 7) % 4;
  };
  const LabelRuns::LabelOf of = label;
  std::vector<double> seen[2];
  for (const unsigned threads : {1u, 3u}) {
    Workers workers(threads);
    const LabelRuns runs({40, 40, 40}, of, workers);
    const Composition c =
        composition_of(runs, glm::dvec3(1), {true, false, true}, settings_of(2, 40), workers, {});
    for (const ScaleRow &row : c.rows)
      seen[threads > 1].push_back(row.fragment_mean), seen[threads > 1].push_back(row.cell_sd);
    seen[threads > 1].push_back(c.all.fragment_error);
  }
  CHECK(seen[0] == seen[1]);
  Workers workers(1);
  const LabelRuns runs({40, 40, 40}, of, workers);
  bool refused = false;
  try {
    composition_of(runs, glm::dvec3(0.05), {true, true, true}, settings_of(2, 75), workers, {});
  } catch (const Error &error) {
    refused = error.status() == CONCEG_E_RANGE;
  }
  CHECK(refused);
}

} // namespace

int main() {
  solid_slabs_and_rods();
  fractals();
  percolation();
  against_a_flood();
  threads_and_bad_input();
  return check_done();
}
