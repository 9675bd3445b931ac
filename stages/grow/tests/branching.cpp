// SPDX-License-Identifier: BSD-3-Clause
// Branching: the hazard against its closed form, the paper's probability, directions, and who may carry a
// bar.
#include "branch.hpp"
#include "check.h"
#include "world.hpp"

using namespace conceg::grow;

namespace {

// Ein(z) = integral of (1 - e^-t) / t from 0 to z, by its midpoint sum.
double ein(double z) {
  double sum = 0.0;
  const int steps = 200000;
  for (int i = 0; i < steps; i++) {
    const double t = z * (i + 0.5) / steps;
    sum += -std::expm1(-t) / t * z / steps;
  }
  return sum;
}

void hazard() {
  for (const double lambda : {0.1, 0.3, 1.0, 3.0}) {
    conceg_rng rng = conceg_rng_stream(2, "test.hazard", 1);
    double sum = 0.0, square = 0.0;
    const int draws = 100000;
    for (int i = 0; i < draws; i++) {
      const double x = early_distance(lambda, 1e4, conceg_rng_exponential(&rng));
      sum += x, square += x * x;
    }
    const double mean = sum / draws, error = std::sqrt((square / draws - mean * mean) / draws);
    CHECK_NEAR(mean, ein(1.0 / lambda) / lambda, 4.0 * error);
  }
  CHECK_NEAR(ein(1.0), 0.79659959929705, 1e-6);
  // Certain at the start, never before the host's place.
  CHECK_NEAR(early_distance(1.0, 5.0, 1e9), 0.0, 0.0);
  CHECK_NEAR(early_distance(1.0, 2.0, 0.0), 2.0, 1e-12);
  // Survival to x < ahead is exp(-(e^{-lambda x} - e^{-lambda ahead}) / lambda h0): its median by hand for
  // lambda 1.
  CHECK_NEAR(early_distance(1.0, 50.0, std::log(2.0)), -std::log(std::log(2.0)), 1e-12);
  CHECK_NEAR(step_probability(1.0, 8.0, 10.0), std::exp(-2.0), 1e-12);
  CHECK_NEAR(step_probability(1.0, 12.0, 10.0), 1.0, 0.0);
}

void directions() {
  const glm::dvec3 heading(0, 0, 1);
  const glm::dvec3 d = daughter_direction(heading, {3, 0, 4}, 1.0, 0.0);
  CHECK_NEAR(glm::dot(d, heading), std::cos(1.0), 1e-12);
  CHECK_NEAR(d.x, std::sin(1.0), 1e-12); // towards the attractor's side
  CHECK_NEAR(d.y, 0.0, 1e-12);
  const glm::dvec3 undecided = daughter_direction(heading, {0, 0, 7}, 1.0, 2.0);
  CHECK_NEAR(glm::length(undecided), 1.0, 1e-12);
  CHECK_NEAR(glm::dot(undecided, heading), std::cos(1.0), 1e-12);
}

// A root bar, an older daughter and a younger one.
void hosts() {
  World world;
  world.make_box(20, true);
  world.add_cell({10, 10, 10}, 2.0);
  world.add_bar(0, -1, 0, 80, {60, 10, 10}, 0.4);
  world.add_bar(0, 0, 10, 60, {10, 60, 10}, 0.4);
  world.add_bar(0, 1, 30, 40, {10, 10, 60}, 0.4);
  State state;
  state.input = world.input();
  state.projections.resize(3);
  state.projections[1].parent = 0, state.projections[2].parent = 1;
  const auto stands = [&](std::uint32_t bar, Phase phase, double path) {
    state.projections[bar].phase = phase;
    state.projections[bar].chain.assign(2, Vertex());
    state.projections[bar].chain[1].path = path;
    state.projections[bar].settled = 2;
  };
  stands(0, Phase::growing, 25.0);
  CHECK_EQUAL(find_host(state, 2), 0); // its parent bar does not grow: the root bar carries it
  stands(1, Phase::growing, 20.0);
  CHECK_EQUAL(find_host(state, 2), 1); // its own parent first
  stands(1, Phase::cut_short, 20.0);
  CHECK_EQUAL(find_host(state, 2), 0);
  CHECK_EQUAL(find_host(state, 1), 0);
  stands(2, Phase::growing, 35.0);
  stands(0, Phase::done, 80.0);
  CHECK_EQUAL(find_host(state, 1), 0); // on the line of one that is done
  stands(0, Phase::cut_short, 25.0);
  CHECK_EQUAL(find_host(state, 1), none); // elder rule: a bar that ends at 40 carries none that ends at 60
  CHECK(!may_find_host(state, 1));
}

// A dead end stops the parent; its daughter is handed to the root bar, and every bar is accounted for.
void handed_on() {
  World world;
  world.make_box(40, true);
  world.add_cell({20, 20, 5}, 2.0);
  world.add_bar(0, -1, 0, 70, {20, 20, 40}, 0.8);
  world.add_bar(0, 0, 4, 29, {80, 20, 12}, 0.8, 1.5);
  world.add_bar(0, 1, 20, 28.5, {80, 40, 12}, 0.8);
  world.make_network(1.0, 0.2, 1.25);
  Parameters parameters;
  parameters.r_min_um = 0.4, parameters.retries = 2;
  const Grown free = grow_world(world, parameters);
  CHECK_EQUAL(free.summary.done, 3);
  // Near the soma room is left in two tunnels only: one up for the root bar, one aside that ends after 7 um.
  for (std::size_t i = 0; i < world.node_radius.size(); i++) {
    const double x = world.node[3 * i] - 20.0, y = world.node[3 * i + 1] - 20.0,
                 z = world.node[3 * i + 2] - 11.0;
    const bool up = std::hypot(x, y)<0.85, aside = x> 0.0 && x < 7.0 && std::hypot(y, z) < 0.85;
    if (!up && !aside && std::fabs(z - 3.0) < 6.0) world.node_radius[i] = 0.05f;
  }
  const Grown grown = grow_world(world, parameters);
  CHECK_EQUAL(grown.bars.state[0], bar_done);
  CHECK_EQUAL(grown.bars.state[1], bar_short);
  CHECK(grown.bars.achieved_end[1] < 20.0);
  CHECK_EQUAL(grown.bars.state[2], bar_handed);
  CHECK_EQUAL(grown.bars.handed_to[2], 0);
  CHECK_NEAR(grown.bars.achieved_start[2], 20.0, 8.0);
}

// The paper's rule: one probability per step.
void per_step() {
  World world;
  world.make_box(30, true);
  world.add_cell({15, 15, 15}, 3.0);
  world.add_random_trees(4, 8, 80, 0.3, 9);
  world.make_network(1.0, 0.2, 1.25);
  Parameters paper;
  paper.hazard = Hazard::per_step, paper.occupancy = Occupancy::nodes, paper.smoothing = 0.0,
  paper.length_factor = true;
  paper.radius_fraction = 1.0, paper.lambda_per_um = 0.3;
  const Grown grown = grow_world(world, paper);
  double early = 0.0;
  std::size_t forks = 0;
  for (std::size_t bar = 0; bar < world.tree.size(); bar++) {
    CHECK_EQUAL(grown.bars.state[bar], bar_done);
    if (world.parent[bar] < 0) continue;
    early += world.start[bar] - grown.bars.achieved_start[bar], forks++;
  }
  CHECK(forks > 10);
  CHECK_NEAR(early / static_cast<double>(forks), 6.0,
             3.5); // about Ein(1 / 0.3) / 0.3 where the host is long enough
}

} // namespace

int main() {
  hazard();
  directions();
  hosts();
  handed_on();
  per_step();
  return check_done();
}
