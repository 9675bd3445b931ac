// SPDX-License-Identifier: BSD-3-Clause
// Course: branches come out as straight as they are asked to be, and closed branches are counted as
// delivered.
#include "course.hpp"
#include "check.h"
#include "straightness.hpp"
#include "world.hpp"

#include <cmath>

using namespace conceg::grow;

namespace {

World open_world() {
  World world;
  world.make_box(50, true);
  for (int c = 0; c < 4; c++) {
    world.add_cell({12.0 + 25.0 * (c & 1), 12.0 + 25.0 * (c >> 1), 12.0 + 25.0 * ((c * 3) % 4 & 1)}, 4.0);
    world.add_random_trees(6, 12, 120, 0.3, 40 + static_cast<unsigned>(c));
  }
  world.make_network(1.0, 0.2, 1.25);
  return world;
}

// Mean and standard error over the delivered branches, by the function that measures donors.
struct Measured {
  double mean, error;
  std::size_t branches;
};
Measured straightness_of(const Skeleton &skeleton) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<glm::dvec3>> lines;
  for (std::uint32_t c = 0; c + 1 < skeleton.cell_offset.size(); c++)
    for (std::size_t i = skeleton.cell_offset[c]; i < skeleton.cell_offset[c + 1]; i++) {
      if (skeleton.parent[i] < 0) continue;
      std::vector<glm::dvec3> &line = lines[{c, skeleton.branch[i]}];
      if (line.empty())
        line.push_back(
            skeleton.position[skeleton.cell_offset[c] + static_cast<std::size_t>(skeleton.parent[i])]);
      line.push_back(skeleton.position[i]);
    }
  double sum = 0.0, square = 0.0, n = 0.0;
  for (const auto &[key, line] : lines) {
    double length = 0.0;
    for (std::size_t i = 1; i < line.size(); i++)
      length += glm::distance(line[i], line[i - 1]);
    if (length < 2.0) continue;
    const double value = conceg::straightness(line, 1.0);
    sum += value, square += value * value, n += 1.0;
  }
  const double variance = square / n - sum / n * sum / n;
  return {sum / n, std::sqrt(variance / n), static_cast<std::size_t>(n)};
}

void as_asked() {
  World world = open_world();
  const Measured free = straightness_of(grow_world(world).skeleton);
  printf("free: %.3f +- %.3f, %zu branches\n", free.mean, free.error, free.branches);
  CHECK(free.branches > 300);
  for (const double asked : {0.94, 0.9, 0.8, 0.68}) {
    world.straightness = asked;
    for (const std::uint64_t seed : {1, 2}) {
      const Grown grown = grow_world(world, {}, 2, seed);
      const Measured got = straightness_of(grown.skeleton);
      printf("asked %.2f: %.3f +- %.3f\n", asked, got.mean, got.error);
      CHECK_NEAR(got.mean, asked, 0.02);
      CHECK_NEAR(measure(grown.state, grown.skeleton).of_type[0].mean(), got.mean, 1e-12);
      CHECK_EQUAL(grown.summary.done, world.tree.size()); // bends do not cost a bar its end
    }
  }
}

// What the control counts of ended projections is what is delivered.
void closed() {
  const Grown grown = grow_world(open_world());
  double sum = 0.0, branches = 0.0;
  for (const Projection &projection : grown.state.projections) {
    const Straightness part = closed_branches(projection);
    sum += part.sum, branches += static_cast<double>(part.branches);
    Projection open = projection;
    open.phase = Phase::growing;
    CHECK(closed_branches(open).branches <= projection.forks.size());
    open.forks.clear();
    CHECK_EQUAL(closed_branches(open).branches, 0);
  }
  const Measured delivered = straightness_of(grown.skeleton);
  CHECK_NEAR(branches, static_cast<double>(delivered.branches), 0.0);
  CHECK_NEAR(sum / branches, delivered.mean, 1e-9);
  CHECK_NEAR(bend_of_length(10.0), 0.5, 1e-15);
}

} // namespace

int main() {
  as_asked();
  closed();
  return check_done();
}
