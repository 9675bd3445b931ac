// SPDX-License-Identifier: BSD-3-Clause
// The forces of the global optimisation, as displacements per iteration (um).
#pragma once

#include "runs.hpp"

namespace conceg::relax {

struct Strength {
  double gap = 0.04;             // um that is kept free between bodies
  double repulsion = 0.3;        // share of an overlap that one iteration takes away
  double attraction = 0.02;      // share of a small gap that one iteration closes, at most
  double attraction_range = 0.2; // um beyond `gap`
  double stretch = 0.5;          // share of a change of length that one iteration takes back
  double bending = 0.02;         // share of a change of bend that one iteration takes back
  double forking = 0.25;         // share of a change of the distance between two sisters that one takes back
  double tension = 0.1;          // share of a section's change of length that enters its rest lengths
  double straightening = 0.01;   // share of what a section's ends are too near that enters the pull on them
};

// What the tissue is like in one iteration: energies in um^2 (forces are displacements), overlaps in um.
struct State {
  double contact_energy = 0, shape_energy = 0;
  double overlap_sum = 0, largest_overlap = 0;
  std::uint64_t overlapping = 0; // pairs
};

// Adds the forces between bodies on each point (pinned nodes are left out) to `force`, one per point, and
// their energy and overlap to `state`. Each element sums over its own list in its order: the same bits for
// any number of threads. Single precision.
class ContactForces {
public:
  void add(const Bodies &bodies, const LaneBodies &lanes, const Runs &runs, const Strength &strength,
           Workers &workers, std::vector<glm::dvec3> &force, State &state);

private:
  struct Ends {
    glm::vec3 a{0}, b{0}; // force on the two ends of an element
  };
  std::vector<Ends> ends_;
  std::vector<State> states_; // per block
};

// Adds the forces that keep the cells' shape: towards the rest length (per point) of each segment and the
// bend at each point.
void add_shape_forces(const Bodies &bodies, const std::vector<double> &rest_length, const Strength &strength,
                      Workers &workers, std::vector<glm::dvec3> &force, State &state);

} // namespace conceg::relax
