// SPDX-License-Identifier: BSD-3-Clause
#include "lanes.hpp"

#include "wrap.hpp"

namespace conceg::relax {

void LaneBodies::fill(const Bodies &bodies, const std::vector<glm::ivec3> &chunk_lift, const conceg_box &box,
                      Workers &workers) {
  const glm::dvec3 sides = side(box), corner(box.lo[0], box.lo[1], box.lo[2]);
  for (std::vector<float> &v : values_)
    v.resize(bodies.elements.size() + lane_count - 1); // a run may read beyond the last element
  workers.loop(bodies.chunks.size(), 256, [&](std::size_t c, unsigned) {
    const glm::dvec3 shift = sides * glm::dvec3(chunk_lift[c]) - corner;
    const Chunk &chunk = bodies.chunks[c];
    for (std::uint32_t e = chunk.first; e < chunk.first + chunk.count; e++) {
      const Element &x = bodies.elements[e];
      const glm::dvec3 a = bodies.position[x.a] + shift, u = bodies.position[x.b] - bodies.position[x.a];
      const double radius_a = bodies.radius[x.radius_a], radius_b = bodies.radius[x.radius_b];
      const double all_of_it[fields] = {
          a.x,      a.y, a.z, u.x, u.y, u.z, radius_a, radius_b - radius_a,
          bodies.pinned[x.a] && bodies.pinned[x.b] ? 1.0 : 0.0};
      for (int field = 0; field < fields; field++)
        values_[field][e] = static_cast<float>(all_of_it[field]);
    }
  });
}

} // namespace conceg::relax
