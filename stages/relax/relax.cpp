// SPDX-License-Identifier: BSD-3-Clause
#include "relax.hpp"

#include "tension.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::relax {

namespace {

// The largest distance between the points now and at `then`; a maximum does not depend on the order.
double largest_shift(const Bodies &bodies, const std::vector<glm::dvec3> &then, Workers &workers) {
  constexpr std::size_t block = 4096;
  const std::size_t blocks = (bodies.points + block - 1) / block;
  std::vector<double> largest(blocks, 0);
  workers.loop(blocks, 1, [&](std::size_t b, unsigned) {
    for (std::size_t i = b * block; i < std::min(bodies.points, (b + 1) * block); i++)
      largest[b] = std::max(largest[b], glm::distance(bodies.position[i], then[i]));
  });
  return blocks ? *std::max_element(largest.begin(), largest.end()) : 0;
}

double cable(const Bodies &bodies) {
  double sum = 0;
  for (std::size_t i = 0; i < bodies.points; i++)
    if (bodies.parent[i] >= 0)
      sum += glm::distance(bodies.position[i], bodies.position[static_cast<std::size_t>(bodies.parent[i])]);
  return sum;
}

// Keeps a coordinate in the box on open axes, unless it was outside from the start.
void keep_inside(const conceg_box &box, const glm::dvec3 &start, glm::dvec3 &p) {
  for (int a = 0; a < 3; a++)
    if (!box.periodic[a])
      p[a] = std::min(std::max(p[a], std::min(box.lo[a], start[a])), std::max(box.hi[a], start[a]));
}

} // namespace

Moved move_bodies(Bodies &bodies, const Sections &sections, const conceg_box &box, const Strength &strength,
                  const Motion &motion, Collider &collider, Workers &workers, const Progress &progress,
                  const Watch &watch) {
  Moved moved;
  const std::vector<glm::dvec3> start(bodies.position.begin(),
                                      bodies.position.begin() + static_cast<std::ptrdiff_t>(bodies.points));
  std::vector<glm::dvec3> listed, pruned, velocity(bodies.points, glm::dvec3(0)), force(bodies.points);
  const double reach = strength.gap + strength.attraction_range, inner = 0.35 * motion.skin;
  const auto points_now = [&] {
    return std::vector<glm::dvec3>(bodies.position.begin(),
                                   bodies.position.begin() + static_cast<std::ptrdiff_t>(bodies.points));
  };
  ContactForces contacts;
  LaneBodies lanes;
  Runs runs, close;
  std::vector<glm::ivec3> lift;
  Tension tension(bodies, sections, strength, motion.step);
  moved.length_before = cable(bodies);
  for (int iteration = 0; iteration < motion.iterations; iteration++) {
    report(progress, "relax", static_cast<std::uint64_t>(iteration),
           static_cast<std::uint64_t>(motion.iterations));
    // A list serves until a point has moved half of what was added to the reach. The lists of all that Embree
    // finds is pruned to what is close more often, which costs little more than one iteration.
    if (listed.empty() || largest_shift(bodies, listed, workers) > 0.5 * (motion.skin - inner)) {
      const ChunkSearch found =
          collider.find_chunks(bodies, bodies.radius, box, reach + motion.skin, workers);
      lift = found.lift, listed = points_now(), pruned.clear();
      lanes.fill(bodies, lift, box, workers);
      runs = make_runs(bodies, found, lanes, box, reach + motion.skin, workers);
      moved.rebuilds++;
    } else
      lanes.fill(bodies, lift, box, workers);
    if (pruned.empty() || largest_shift(bodies, pruned, workers) > 0.5 * inner) {
      prune_runs(bodies, runs, lanes, reach + inner, workers, close);
      pruned = points_now(), moved.prunes++, moved.runs = close.count();
    }
    std::fill(force.begin(), force.end(), glm::dvec3(0));
    State state;
    contacts.add(bodies, lanes, close, strength, workers, force, state);
    add_shape_forces(bodies, tension.rest_length(), strength, workers, force, state);
    tension.add_forces(bodies, force);
    moved.states.push_back(state);
    if (watch) watch(iteration, state);
    // Pairs that cannot come apart would swing for ever: steps get shorter.
    const double step = motion.step * (1 - 0.8 * iteration / motion.iterations);
    workers.loop(bodies.points, 2048, [&](std::size_t i, unsigned) {
      if (bodies.pinned[i]) return;
      velocity[i] = motion.momentum * velocity[i] + force[i];
      const double speed = glm::length(velocity[i]);
      if (speed > step) velocity[i] *= step / speed;
      bodies.position[i] += velocity[i];
      keep_inside(box, start[i], bodies.position[i]);
    });
    tension.update(bodies, workers);
  }
  for (std::size_t i = 0; i < bodies.points; i++)
    moved.mean_shift += glm::distance(bodies.position[i], start[i]);
  if (bodies.points) moved.mean_shift /= static_cast<double>(bodies.points);
  moved.largest_shift = largest_shift(bodies, start, workers);
  moved.length_after = cable(bodies);
  return moved;
}

} // namespace conceg::relax
