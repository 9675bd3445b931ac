// SPDX-License-Identifier: BSD-3-Clause
#include "spheres.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::relax {

namespace {
constexpr double most_pieces = 1e5; // spheres of one segment
}

Spheres resample(const Skeletons &skeletons, double spacing) {
  if (!(spacing > 0)) fail(CONCEG_E_RANGE, "sphere_spacing: expected a number above 0, got %g", spacing);
  Spheres out;
  out.cell_offset.push_back(0);
  for (std::size_t cell = 0; cell < skeletons.soma.size(); cell++) {
    const std::size_t first = skeletons.cell_offset[cell], end = skeletons.cell_offset[cell + 1];
    const auto add = [&](const glm::dvec3 &center, float radius, std::int64_t segment_end) {
      out.center.push_back(center), out.radius.push_back(radius), out.segment_end.push_back(segment_end);
    };
    if (skeletons.soma_radius[cell] > 0) add(skeletons.soma[cell], skeletons.soma_radius[cell], -1);
    for (std::size_t i = first; i < end; i++) {
      const auto row = static_cast<std::int64_t>(i - first);
      if (skeletons.parent[i] < 0) {
        add(skeletons.position[i], skeletons.radius[i], row);
        continue;
      }
      const std::size_t parent = first + static_cast<std::size_t>(skeletons.parent[i]);
      const glm::dvec3 start = skeletons.position[parent], along = skeletons.position[i] - start;
      const double radius = skeletons.radius[parent], change = skeletons.radius[i] - radius;
      const double step = spacing * std::min<double>(skeletons.radius[parent], skeletons.radius[i]);
      const double pieces = std::max(1.0, std::ceil(glm::length(along) / step));
      if (!(pieces < most_pieces))
        fail(CONCEG_E_RANGE,
             "/skeleton/radius[%zu]: a segment of %g um with radius %g um would need %g spheres; raise "
             "relax.radius_min_um",
             i, glm::length(along), std::min<double>(skeletons.radius[parent], skeletons.radius[i]), pieces);
      for (double k = 1; k <= pieces; k++)
        add(start + along * (k / pieces),
            k == pieces ? skeletons.radius[i] : static_cast<float>(radius + change * (k / pieces)), row);
    }
    out.cell_offset.push_back(out.center.size());
  }
  return out;
}

} // namespace conceg::relax
