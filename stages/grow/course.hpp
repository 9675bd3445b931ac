// SPDX-License-Identifier: BSD-3-Clause
// Course: the straightness of the branches of each type, steered to what its dictionary entry asks while they
// grow.
#pragma once

#include "state.hpp"

namespace conceg::grow {

// As the dictionary's straightness is measured.
constexpr double resample_um = 1.0, shortest_branch_um = 2.0;

// ---- What one step needs ----
bool steered(const State &state, std::uint32_t bar);
// Strength of the smoothing of a bar's line.
double smoothing_of(const State &state, std::uint32_t bar);
// f, the weight of the radius term: what has to run straighter than smoothing makes it turns less out of the
// way.
double radius_weight(const State &state, std::uint32_t cell);
// Where a tip aims that should grow towards `target`: turned aside by the bar's wander, as far away as
// before.
glm::dvec3 wandering_target(const State &state, std::uint32_t bar, const glm::dvec3 &tip, double path,
                            const glm::dvec3 &target);
// Draws the wander of a bar that has taken its first edge. May run beside others.
void draw_wander(State &state, std::uint32_t bar);

// Straightness summed over branches.
struct Straightness {
  double sum = 0.0;
  double bend = 0.0; // of bend_of_length, summed too
  std::uint64_t branches = 0;
  double mean() const { return branches ? sum / static_cast<double>(branches) : 0.0; }
};
// The share of its bends that a branch of this length shows: short ones are straighter than their course. In
// [0, 1).
double bend_of_length(double length);
// Of the branches of a projection that can no longer change: up to its last fork, or to its tip once it
// ended.
Straightness closed_branches(const Projection &projection);

// ---- Control: serial, from committed state only ----
class Steering {
public:
  explicit Steering(State &state);
  // A fork or the end of this projection changed.
  void touch(std::uint32_t bar);
  // After a round: sets the course of each type by the straightness of its closed branches.
  void steer();

private:
  State &state_;
  double crowding_ = 0.0;
  std::vector<Straightness> of_bar_, of_type_;
  std::vector<Straightness> expected_; // of each type: how many branches its bars have, and how they bend
  std::vector<std::uint32_t> touched_;
};

} // namespace conceg::grow
