// SPDX-License-Identifier: BSD-3-Clause
#include "lanes.hpp"

#include "wrap.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::relax {

void LaneBodies::fill(const Bodies &bodies, const std::vector<glm::ivec3> &chunk_lift, const conceg_box &box,
                      Workers &workers) {
  const glm::dvec3 sides = side(box), corner(box.lo[0], box.lo[1], box.lo[2]);
  four_.resize(bodies.chunks.size());
  balls_.resize(bodies.chunks.size());
  workers.loop(bodies.chunks.size(), 256, [&](std::size_t c, unsigned) {
    const glm::dvec3 shift = sides * glm::dvec3(chunk_lift[c]) - corner;
    const Chunk &chunk = bodies.chunks[c];
    Four four = {};
    FourBalls balls = {};
    const auto put = [](Vec &out, std::uint32_t lane, const glm::dvec3 &v) {
      out.x[lane] = static_cast<float>(v.x), out.y[lane] = static_cast<float>(v.y),
      out.z[lane] = static_cast<float>(v.z);
    };
    for (std::uint32_t lane = 0; lane < chunk.count; lane++) {
      const Element &x = bodies.elements[chunk.first + lane];
      const glm::dvec3 a = bodies.position[x.a] + shift, u = bodies.position[x.b] - bodies.position[x.a];
      const double radius_a = bodies.radius[x.radius_a], radius_b = bodies.radius[x.radius_b];
      put(four.a, lane, a), put(four.u, lane, u), put(balls.middle, lane, a + 0.5 * u);
      four.r[lane] = static_cast<float>(radius_a), four.dr[lane] = static_cast<float>(radius_b - radius_a);
      four.pinned[lane] = bodies.pinned[x.a] && bodies.pinned[x.b] ? 1.0f : 0.0f;
      balls.radius[lane] = static_cast<float>(0.5 * glm::length(u) + std::max(radius_a, radius_b));
    }
    four_[c] = four, balls_[c] = balls;
  });
}

} // namespace conceg::relax
