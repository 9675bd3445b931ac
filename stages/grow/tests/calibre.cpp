// SPDX-License-Identifier: BSD-3-Clause
// Calibre: spread, correlation length and mean of the grown radii about their taper, forks, the floor,
// identity.
#include "calibre.hpp"
#include "check.h"
#include "world.hpp"

#include <cmath>

using namespace conceg::grow;

namespace {

constexpr double sd = 0.25, correlation_length_um = 4.0;

World long_bars(double floor_um) {
  World world;
  world.make_box(50, true);
  world.add_cell({25, 25, 25}, 5.0);
  world.add_random_trees(10, 12, 260, 0.4, 5);
  world.floor.assign(world.tree.size(), floor_um);
  world.taper.assign(world.tree.size(), -5e-4);
  world.make_network(1.0, 0.2, 1.25);
  return world;
}

Grown grow_thin(const World &world) {
  Parameters parameters;
  parameters.r_min_um = 0.02;
  return grow_world(world, parameters);
}

// The stray of every delivered vertex of a bar, and the path length where it stands.
struct Place {
  double path, stray;
};
std::vector<std::vector<Place>> strays(const Grown &grown) {
  std::vector<std::vector<Place>> bars(grown.state.projections.size());
  const Skeleton &s = grown.skeleton;
  std::vector<double> path(s.position.size(), 0.0);
  for (std::size_t i = 0; i < s.position.size(); i++) {
    if (s.parent[i] >= 0) {
      const auto p = static_cast<std::size_t>(s.parent[i]);
      path[i] = path[p] + glm::distance(s.position[i], s.position[p]);
    }
    bars[s.bar[i]].push_back(
        {path[i], std::log(s.target_radius[i] / law_radius(grown.state, s.bar[i], path[i]))});
  }
  return bars;
}

// Of all grown bars: within three standard errors of what was asked.
void spread_and_length() {
  World world = long_bars(0.02);
  world.calibre.assign(world.tree.size(), {sd, correlation_length_um});
  const Grown grown = grow_thin(world);
  double sum = 0.0, square = 0.0, product = 0.0, mean_factor = 0.0, cable = 0.0, lag = 0.0;
  std::size_t number = 0, pairs = 0;
  for (const std::vector<Place> &bar : strays(grown)) {
    if (bar.empty()) continue;
    cable += bar.back().path - bar.front().path;
    for (std::size_t i = 0, j = 0; i < bar.size(); i++) {
      const double g = bar[i].stray + 0.5 * sd * sd;
      sum += g, square += g * g, mean_factor += std::exp(bar[i].stray), number++;
      while (j < bar.size() && bar[j].path < bar[i].path + correlation_length_um)
        j++;
      if (j == bar.size()) continue;
      product += g * (bar[j].stray + 0.5 * sd * sd), lag += bar[j].path - bar[i].path, pairs++;
    }
  }
  const double n = static_cast<double>(number), p = static_cast<double>(pairs);
  const double found_sd = std::sqrt(square / n - sum / n * sum / n);
  const double found_length = -(lag / p) / std::log(product / p / (found_sd * found_sd));
  // Standard errors of an Ornstein-Uhlenbeck line of that length: of its variance 2 L / T, of its mean 2 L /
  // T, of its autocorrelation at L 0.59 L / T (Bartlett).
  const double part = correlation_length_um / cable;
  const double sd_error = 0.5 * std::sqrt(2.0 * part), mean_error = sd * std::sqrt(2.0 * part);
  const double length_error = std::sqrt(0.59 * part) * std::exp(1.0);
  printf("%.0f um of cable: sd %.4f +- %.4f, correlation length %.2f +- %.2f um, mean factor %.4f +- %.4f\n",
         cable, found_sd, sd_error * sd, found_length, length_error * correlation_length_um, mean_factor / n,
         mean_error);
  CHECK(cable > 4000.0);
  CHECK_NEAR(found_sd / sd, 1.0, 3.0 * sd_error);
  CHECK_NEAR(found_length / correlation_length_um, 1.0, 3.0 * length_error);
  CHECK_NEAR(mean_factor / n, 1.0, 3.0 * mean_error);
}

// A daughter starts at its parent's value, and each bar goes its own way from there.
void forks() {
  World world = long_bars(0.02);
  world.calibre.assign(world.tree.size(), {sd, correlation_length_um});
  const Grown grown = grow_thin(world);
  std::size_t daughters = 0;
  double apart = 0.0;
  for (const Projection &projection : grown.state.projections) {
    if (projection.host == none || projection.chain.size() < 2) continue;
    const Walk &host = grown.state.projections[projection.host].calibre;
    CHECK_NEAR(projection.calibre.at(projection.start_path), host.at(projection.start_path), 1e-6);
    apart += std::fabs(projection.calibre.at(projection.start_path + 20.0) -
                       host.at(projection.start_path + 20.0));
    daughters++;
  }
  CHECK(daughters > 50);
  CHECK(apart / static_cast<double>(daughters) > 0.5);
}

// The floor holds, committed radii obey the clearance, and growth turns nowhere else because a bulge is
// ahead.
void floors_and_room() {
  World world = long_bars(0.3);
  world.calibre.assign(world.tree.size(), {sd, correlation_length_um});
  const Grown grown = grow_thin(world);
  std::size_t bulges = 0, at_floor = 0;
  for (std::size_t i = 0; i < grown.skeleton.radius.size(); i++) {
    const float target = grown.skeleton.target_radius[i];
    CHECK(target >= 0.3f - 1e-6f);
    at_floor += target < 0.3001f;
    bulges += target > 0.55f;
    CHECK(grown.skeleton.radius[i] <= 0.6f * target + 1e-6f);
  }
  CHECK(bulges > 50 && at_floor > 50);
  CHECK_NEAR(deepest_overlap(world, grown.skeleton), 0.0, 0.0);
}

// g belongs to the bar: another cell beside it, which is grown between its steps, changes nothing.
void identity() {
  World alone = long_bars(0.02), beside = long_bars(0.02);
  beside.add_cell({5, 5, 5}, 3.0);
  beside.add_random_trees(4, 8, 150, 0.4, 6);
  for (World *world : {&alone, &beside})
    world->calibre.assign(world->tree.size(), {sd, correlation_length_um});
  const Grown one = grow_thin(alone), two = grow_thin(beside);
  CHECK(!same_bytes(one.skeleton.position, two.skeleton.position));
  for (std::size_t bar = 0; bar < alone.tree.size(); bar++) {
    if (alone.parent[bar] >= 0) continue;
    for (double path = 0.0; path < 200.0; path += 7.3)
      CHECK_NEAR(one.state.projections[bar].calibre.at(path), two.state.projections[bar].calibre.at(path),
                 0.0);
  }
}

} // namespace

int main() {
  spread_and_length();
  forks();
  floors_and_room();
  identity();
  return check_done();
}
