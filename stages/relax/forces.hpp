// SPDX-License-Identifier: BSD-3-Clause
// The forces of the global optimisation, as displacements per iteration (um).
#pragma once

#include "collide.hpp"

namespace conceg::relax {

struct Strength {
  double gap = 0.04;             // um that is kept free between bodies
  double repulsion = 0.3;        // share of an overlap that one iteration takes away
  double attraction = 0.02;      // share of a small gap that one iteration closes, at most
  double attraction_range = 0.2; // um beyond `gap`
  double stretch = 0.5;          // share of a change of length that one iteration takes back
  double bending = 0.02;         // share of a change of bend that one iteration takes back
};

// Forces between the bodies of a fixed list of pairs. Each pair is worked out once, and each point then adds
// up its own pairs in the order of the list: the same sums for any number of threads.
class PairForces {
public:
  // Takes a new list; pairs sorted as Collider gives them.
  void set_pairs(const Bodies &bodies, std::vector<Pair> pairs);
  const std::vector<Pair> &pairs() const { return pairs_; }
  // Adds the force on each point (pinned nodes are left out) to `force` (one per point).
  void add(const Bodies &bodies, const Strength &strength, const glm::dvec3 &side, Workers &workers,
           std::vector<glm::dvec3> &force);

private:
  struct Contact {
    glm::dvec3 push; // on the first body at s; the second gets the opposite at t
    double first_share, second_share, s, t;
  };
  std::vector<Pair> pairs_;
  std::vector<Contact> contacts_;
  std::vector<std::uint64_t>
      offset_; // CSR: pairs of each element; the lowest bit tells which body of the pair it is
  std::vector<std::uint64_t> incident_;
};

// Adds the forces that keep the cells' shape: towards rest length of each segment and the bend at each point.
void add_shape_forces(const Bodies &bodies, const Strength &strength, Workers &workers,
                      std::vector<glm::dvec3> &force);

} // namespace conceg::relax
