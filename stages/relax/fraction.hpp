// SPDX-License-Identifier: BSD-3-Clause
// The share of the box inside the bodies, from geometry: points of a low-discrepancy sequence.
#pragma once

#include "collide.hpp"

namespace conceg::relax {

// Points of the box and the elements near each, over all periodic images. Serves for any radii up to those it
// was made with.
struct Sample {
  struct Near {
    std::uint32_t element;
    std::int32_t lift[3];
  };
  std::vector<glm::dvec3> point;
  std::vector<std::uint64_t> offset; // CSR by point, sorted by (cell, lift)
  std::vector<Near> near;
};

// `count` points; elements count as near within `reach` of their surface at the radii given. E_RANGE when
// bodies meet too many images of themselves.
Sample make_sample(const Bodies &bodies, const std::vector<double> &most, const conceg_box &box,
                   std::size_t count, double reach, Workers &workers);

struct Fractions {
  double united = 0;  // inside some body
  double several = 0; // inside bodies of two cells or images
  double planes =
      0; // inside after bodies in contact are cut at their contact planes, `gap` apart: equation (7)
};
// `gap` at most the reach of the sample. The same for any number of threads.
Fractions fractions_of(const Bodies &bodies, const std::vector<double> &radius, const glm::dvec3 &side,
                       const Sample &sample, double gap, Workers &workers);

} // namespace conceg::relax
