// SPDX-License-Identifier: BSD-3-Clause
#include "pack.hpp"

#include <algorithm>

namespace conceg::relax {

namespace {

constexpr int steps_per_round = 8;
constexpr double last_widening = 0.3; // of the first

} // namespace

Packed pack(Bodies &bodies, const Sections &sections, const conceg_box &box, const Strength &strength,
            const Motion &motion, const Rounds &rounds, Collider &collider, Workers &workers,
            const Progress &progress) {
  Packed packed;
  const std::vector<double> target = bodies.radius;
  std::vector<double> most = target;
  if (rounds.count)
    for (std::size_t i = 0; i < bodies.points; i++)
      most[i] *= rounds.most;
  Motion short_motion = motion;
  short_motion.iterations = steps_per_round;
  for (int round = 0;; round++) {
    if (round == rounds.count) packed.parted = part(bodies, box, strength.gap, collider, workers);
    const std::vector<Pair> pairs = collider.find(bodies, most, box, strength.gap, workers).pairs;
    std::vector<double> radius = target;
    packed.cut = cut_radii(bodies, pairs, side(box), strength.gap, most, radius, workers, progress);
    if (round == rounds.count) {
      packed.radius = radius;
      return packed;
    }
    report(progress, "relax: pack", static_cast<std::uint64_t>(round),
           static_cast<std::uint64_t>(rounds.count));
    const double widening = rounds.widening * (1 - (1 - last_widening) * round / rounds.count);
    for (std::size_t i = 0; i < bodies.points; i++)
      bodies.radius[i] = std::min(most[i], radius[i] + widening);
    move_bodies(bodies, sections, box, strength, short_motion, collider, workers, {});
    bodies.radius = target;
  }
}

} // namespace conceg::relax
