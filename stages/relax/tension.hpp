// SPDX-License-Identifier: BSD-3-Clause
// Keeps the path length of each section and the distance of its ends, of which wriggling round neighbours
// takes away: equations (3) and (4) of the README.
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
  // other.
  void add_forces(const Bodies &bodies, std::vector<glm::dvec3> &force) const;

private:
  glm::dvec3 end_to_end(const Bodies &bodies, std::size_t section) const;
  double missing(const Bodies &bodies, std::size_t section) const;

  const Sections &sections_;
  double tension_, straightening_, most_pull_;
  std::vector<double> scale_, rest_;                // of the rest lengths per section; rest length per point
  std::vector<double> chord_, straightness_, pull_; // per section
};

} // namespace conceg::relax
