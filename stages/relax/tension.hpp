// SPDX-License-Identifier: BSD-3-Clause
// Keeps the path length of each section and the distance of its ends, of which wriggling round neighbours
// takes away, and the angles of forks: equations (3) to (5) of the README.
#pragma once

#include "forces.hpp"
#include "shape.hpp"

namespace conceg::relax {

class Tension {
public:
  // Length and straightness of each section as they stand are those to keep. No pull exceeds
  // `most_pull`, um.
  Tension(const Bodies &bodies, const Sections &sections, const Strength &strength, double most_pull);
  // After the bodies have moved.
  void update(const Bodies &bodies, Workers &workers);
  const std::vector<double> &rest_length() const { return rest_; } // per point, um
  // Pulls the ends of each section apart, or together, with a force that runs linearly from one end to the
  // other, and the first points of the two daughters of each fork.
  void add_forces(const Bodies &bodies, std::vector<glm::dvec3> &force) const;

private:
  glm::dvec3 end_to_end(const Bodies &bodies, std::size_t section) const;
  double missing(const Bodies &bodies, std::size_t section) const;

  // The first points of the two daughters of a fork, the cosine of their angle at the start, and by what
  // their distance is multiplied now.
  struct Fork {
    std::uint32_t at, one, other;
    double cosine, scale;
  };
  static double wanted(const Bodies &bodies, const Fork &fork);

  const Sections &sections_;
  double forking_;
  std::vector<Fork> forks_;
  double tension_, straightening_, most_pull_;
  std::vector<double> scale_, rest_;                // of the rest lengths per section; rest length per point
  std::vector<double> chord_, straightness_, pull_; // per section
};

} // namespace conceg::relax
