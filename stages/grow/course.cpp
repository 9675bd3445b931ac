// SPDX-License-Identifier: BSD-3-Clause
#include "course.hpp"

#include "straightness.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::grow {

namespace {

constexpr double natural = 0.92;       // straightness in an open network without any steering
constexpr double open_share = 0.35;    // of the box: what cells may fill without being in each other's way
constexpr double crowding_takes = 0.3; // off the straightness, per share filled beyond that
constexpr double crowding_grows = 0.4; // by so much more from the first branch to the last
constexpr double smoothest = 0.02;     // what full smoothing adds to it
constexpr double straightest = 0.12;   // with f down to its last tenth, in crowded tissue
constexpr double most_given_up = 0.9;
constexpr double most_wander = 0.5; // farther down, tips walk at random
// Squared weight of the wander that takes `less` off the straightness: less (1 + growth less) / gain,
// measured.
constexpr double wander_gain = 0.52, wander_growth = 4.0;
constexpr double wander_length_um = 2.0; // a bend, not a zigzag of single steps; short against a branch
constexpr double patience = 0.05;        // share of a type's branches over which a deficit is made good
constexpr double bend_um = 10.0;         // length of a branch that shows half of its bends, measured
constexpr double least_branches = 10.0;

std::uint32_t type_of(const State &state, std::uint32_t cell) {
  return state.input.types.of_cell ? state.input.types.of_cell[cell] : 0;
}

std::uint32_t type_of_bar(const State &state, std::uint32_t bar) {
  return type_of(state, state.projections[bar].cell);
}

bool asks(const State &state, std::uint32_t type) {
  const std::vector<double> &asked = state.input.types.straightness;
  return type < asked.size() && asked[type] > 0.0;
}

// The branches that a bar has as it is asked: its daughters cut it where they start.
void expect_branches(const State &state, std::uint32_t bar, Straightness &sum) {
  const Bars &bars = state.input.bars;
  std::vector<double> cut = {bars.asked_start[bar], bars.asked_end[bar]};
  for (const std::uint32_t child : state.children[bar])
    cut.push_back(bars.asked_start[child]);
  std::sort(cut.begin(), cut.end());
  for (std::size_t i = 1; i < cut.size(); i++) {
    const double length = cut[i] - cut[i - 1];
    if (length >= shortest_branch_um) sum.bend += bend_of_length(length), sum.branches++;
  }
}

// Share of the box that the cells will fill at their target radii, beyond what leaves them alone.
double crowding(const Input &input) {
  const double pi = 3.14159265358979323846;
  double volume = 0.0, box = 1.0;
  for (int axis = 0; axis < 3; axis++)
    box *= conceg_box_side(&input.box, axis);
  for (std::size_t cell = 0; cell < input.cells.count; cell++)
    volume += 4.0 / 3.0 * pi * std::pow(input.cells.radius[cell], 3);
  for (std::size_t bar = 0; bar < input.bars.count; bar++)
    volume += pi * input.bars.radius[bar] * input.bars.radius[bar] *
              (input.bars.asked_end[bar] - input.bars.asked_start[bar]);
  return std::max(0.0, volume / box - open_share);
}

double limited(double course) {
  return std::clamp(course, -most_wander, straightest);
}

} // namespace

bool steered(const State &state, std::uint32_t bar) {
  return !state.course.empty() && asks(state, type_of_bar(state, bar));
}

double smoothing_of(const State &state, std::uint32_t bar) {
  const double base = state.parameters.smoothing;
  if (!steered(state, bar)) return base;
  return base + (1.0 - base) * std::clamp(state.course[type_of_bar(state, bar)] / smoothest, 0.0, 1.0);
}

glm::dvec3 wandering_target(const State &state, std::uint32_t bar, const glm::dvec3 &tip, double path,
                            const glm::dvec3 &target) {
  const Projection &projection = state.projections[bar];
  if (!projection.wander[0].drawn() || !steered(state, bar)) return target;
  const double less = std::max(0.0, -state.course[type_of_bar(state, bar)]);
  const double weight = std::sqrt(less * (1.0 + wander_growth * less) / wander_gain);
  const glm::dvec3 ahead = target - tip;
  const double far = glm::length(ahead);
  if (!(weight > 0.0) || !(far > 0.0)) return target;
  const glm::dvec3 along = ahead / far;
  const glm::dvec3 drift(projection.wander[0].at(path), projection.wander[1].at(path),
                         projection.wander[2].at(path));
  return tip + far * glm::normalize(along + weight * drift);
}

void draw_wander(State &state, std::uint32_t bar) {
  if (!steered(state, bar)) return;
  Projection &projection = state.projections[bar];
  const std::uint64_t row = bar - state.input.bars.cell_offset[projection.cell];
  conceg_rng stream = conceg_rng_stream(state.input.seed, "grow.wander",
                                        conceg_rng_mix(state.input.cells.id[projection.cell]) + row);
  for (Walk &walk : projection.wander) {
    const double first = first_value(stream);
    walk.draw(projection.start_path, state.input.bars.asked_end[bar], wander_length_um, first, stream);
    stream.counter += 1ull << 32; // far beyond what one walk draws
  }
}

double bend_of_length(double length) {
  return length / (length + bend_um);
}

double radius_weight(const State &state, std::uint32_t cell) {
  const std::uint32_t type = type_of(state, cell);
  if (state.course.empty() || !asks(state, type)) return state.parameters.f;
  const double more = std::clamp((state.course[type] - smoothest) / (straightest - smoothest), 0.0, 1.0);
  return state.parameters.f * (1.0 - most_given_up * more);
}

Straightness closed_branches(const Projection &projection) {
  Straightness found;
  const std::vector<Vertex> &chain = projection.chain;
  if (chain.size() < 2) return found;
  std::vector<Fork> forks = projection.forks;
  std::sort(forks.begin(), forks.end(), [](const Fork &x, const Fork &y) { return x.path < y.path; });
  ResampledPath line(chain[0].position, resample_um);
  double from = chain[0].path;
  const auto close = [&](double path, const glm::dvec3 &next) {
    if (path - from >= shortest_branch_um)
      found.sum += line.straightness(), found.bend += bend_of_length(path - from), found.branches++;
    line = ResampledPath(next, resample_um), from = path;
  };
  const bool ended = projection.phase == Phase::done || projection.phase == Phase::cut_short;
  std::size_t next = 0;
  for (std::size_t i = 1; i < chain.size() && (ended || next < forks.size()); i++) {
    for (; next < forks.size() && forks[next].path <= chain[i].path; next++) {
      line.add(forks[next].position);
      close(forks[next].path, forks[next].position);
    }
    line.add(chain[i].position);
  }
  if (ended) close(chain.back().path, chain.back().position);
  return found;
}

Steering::Steering(State &state) : state_(state) {
  const std::size_t types = state.input.types.straightness.size();
  if (types == 0) return;
  of_bar_.resize(state.projections.size()), of_type_.resize(types);
  expected_.resize(types);
  crowding_ = crowding(state.input);
  for (std::uint32_t bar = 0; bar < state.projections.size(); bar++)
    expect_branches(state, bar, expected_[type_of_bar(state, bar)]);
  state.course.assign(types, 0.0);
  steer();
}

void Steering::touch(std::uint32_t bar) {
  if (!of_bar_.empty()) touched_.push_back(bar);
}

void Steering::steer() {
  for (const std::uint32_t bar : touched_) {
    Straightness &type = of_type_[type_of_bar(state_, bar)], &old = of_bar_[bar];
    const Straightness now = closed_branches(state_.projections[bar]);
    type.sum += now.sum - old.sum, type.bend += now.bend - old.bend;
    type.branches = type.branches + now.branches - old.branches;
    old = now;
  }
  touched_.clear();
  for (std::uint32_t type = 0; type < of_type_.size(); type++) {
    if (!asks(state_, type)) continue;
    const double asked = state_.input.types.straightness[type];
    const Straightness &closed = of_type_[type], &all = expected_[type];
    if (all.branches == 0) continue;
    // Short branches close first, and are straighter: each is held to what its length should show. The
    // deficit is summed, so that the mean of all branches, not of the last, comes to what is asked.
    const double bends = (1.0 - asked) * closed.bend / (all.bend / static_cast<double>(all.branches));
    const double done = static_cast<double>(closed.branches), number = static_cast<double>(all.branches);
    // Where it will be crowded the first branches must be straighter than the last can be.
    const double ahead = 0.5 * crowding_grows * crowding_ * done * std::max(0.0, 1.0 - done / number);
    const double deficit = done - bends - closed.sum + ahead;
    const double over = std::max(least_branches, patience * number);
    state_.course[type] = limited(asked - natural + crowding_takes * crowding_ + deficit / over);
  }
}

} // namespace conceg::grow
