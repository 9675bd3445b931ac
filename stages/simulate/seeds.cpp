// SPDX-License-Identifier: BSD-3-Clause
#include "seeds.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <numeric>

namespace conceg::simulate {

namespace {

constexpr std::uint64_t tries_limit = 10000000;

} // namespace

// Each walker draws points from a stream of its own until one lies in what is wanted; all that still wait
// draw together, so that points are located in batches.
Seeds seed_walkers(const conceg_box &box, const Wanted &wanted, std::uint64_t count, std::uint64_t seed,
                   const Locate &locate, Workers &workers, const Progress &progress) {
  for (int axis = 0; axis < 3; axis++)
    if (!(2.0 * wanted.margin_um < conceg_box_side(&box, axis)))
      fail(CONCEG_E_RANGE, "margin_um: expected less than half of the box (%g um along axis %d), got %g",
           conceg_box_side(&box, axis), axis, wanted.margin_um);
  Seeds out;
  out.position.resize(count), out.cell.resize(count);
  std::vector<conceg_rng> streams(count);
  for (std::uint64_t i = 0; i < count; i++)
    streams[i] = conceg_rng_stream(seed, "simulate.seed", i);
  std::vector<std::uint64_t> waiting(count);
  std::iota(waiting.begin(), waiting.end(), 0);
  while (!waiting.empty()) {
    report(progress, "seeding walkers", count - waiting.size(), count);
    constexpr std::size_t batch = 256;
    workers.loop((waiting.size() + batch - 1) / batch, 1, [&](std::size_t b, unsigned) {
      const std::size_t begin = b * batch, end = std::min(waiting.size(), begin + batch);
      glm::dvec3 point[batch];
      std::int64_t cell[batch];
      for (std::size_t i = begin; i < end; i++)
        for (int axis = 0; axis < 3; axis++)
          point[i - begin][axis] = box.lo[axis] + wanted.margin_um +
                                   (conceg_box_side(&box, axis) - 2.0 * wanted.margin_um) *
                                       conceg_rng_uniform(&streams[waiting[i]]);
      locate(point, end - begin, cell);
      for (std::size_t i = begin; i < end; i++)
        out.position[waiting[i]] = point[i - begin], out.cell[waiting[i]] = cell[i - begin];
    });
    out.tried += waiting.size();
    waiting.erase(std::remove_if(waiting.begin(), waiting.end(),
                                 [&](std::uint64_t i) {
                                   const std::int64_t cell = out.cell[i];
                                   return cell < 0 ? wanted.extra
                                                   : wanted.cells[static_cast<std::size_t>(cell)] != 0;
                                 }),
                  waiting.end());
    if (waiting.size() == count && out.tried >= tries_limit)
      fail(CONCEG_E_RANGE,
           "compartment: expected room for walkers, found none at %llu points of the box; ask for another "
           "compartment, cell or class, or a smaller margin_um",
           static_cast<unsigned long long>(out.tried));
  }
  return out;
}

} // namespace conceg::simulate
