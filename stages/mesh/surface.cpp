// SPDX-License-Identifier: BSD-3-Clause
#include "surface.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace conceg::mesh {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

double six_volumes(const Triangle &t) {
  return glm::dot(t[0], cross_product(t[1], t[2]));
}

glm::dvec3 clamped(const conceg_box &box, const glm::dvec3 &origin, glm::dvec3 p) {
  for (int axis = 0; axis < 3; axis++)
    if (!box.periodic[axis])
      p[axis] = std::min(box.hi[axis] - origin[axis], std::max(box.lo[axis] - origin[axis], p[axis]));
  return p;
}

// Splits at the planes of the open axes from `plane` on (2 axis + 0 low, + 1 high) and sums the clamped
// pieces: outside the box the clamped surface lies in the box's faces and encloses nothing.
double six_volumes_inside(const Triangle &t, const conceg_box &box, const glm::dvec3 &origin, int plane) {
  for (; plane < 6; plane++) {
    const int axis = plane / 2;
    if (box.periodic[axis]) continue;
    const double cut = (plane % 2 ? box.hi[axis] : box.lo[axis]) - origin[axis];
    int below = 0, above = 0;
    for (const glm::dvec3 &p : t)
      below += p[axis]<cut, above += p[axis]> cut;
    if (!below || !above) continue;
    int lone = 0; // the corner that has its side of the plane for itself
    for (int i = 0; i < 3; i++)
      if (below == 1 ? t[i][axis] < cut : above == 1 ? t[i][axis] > cut : t[i][axis] == cut) lone = i;
    const glm::dvec3 &a = t[lone], &b = t[(lone + 1) % 3], &c = t[(lone + 2) % 3];
    const auto on_plane = [&](const glm::dvec3 &p, const glm::dvec3 &q) {
      glm::dvec3 x = p + (q - p) * ((cut - p[axis]) / (q[axis] - p[axis]));
      x[axis] = cut;
      return x;
    };
    const glm::dvec3 ab = b[axis] == cut ? b : on_plane(a, b), ac = c[axis] == cut ? c : on_plane(a, c);
    return six_volumes_inside({a, ab, ac}, box, origin, plane + 1) +
           six_volumes_inside({ab, b, c}, box, origin, plane + 1) +
           six_volumes_inside({ab, c, ac}, box, origin, plane + 1);
  }
  return six_volumes({clamped(box, origin, t[0]), clamped(box, origin, t[1]), clamped(box, origin, t[2])});
}

Triangle triangle(const SurfaceView &surface, std::size_t face) {
  const glm::uvec3 &f = surface.face[face];
  return {surface.from_origin(f.x), surface.from_origin(f.y), surface.from_origin(f.z)};
}

} // namespace

double volume_of(const SurfaceView &surface) {
  double sum = 0;
  for (std::size_t f = 0; f < surface.faces; f++)
    sum += six_volumes(triangle(surface, f));
  return sum / 6;
}

double area_of(const SurfaceView &surface) {
  double sum = 0;
  for (std::size_t f = 0; f < surface.faces; f++) {
    const Triangle t = triangle(surface, f);
    sum += glm::length(cross_product(t[1] - t[0], t[2] - t[0]));
  }
  return sum / 2;
}

double volume_inside(const SurfaceView &surface, const conceg_box &box) {
  double sum = 0;
  for (std::size_t f = 0; f < surface.faces; f++)
    sum += six_volumes_inside(triangle(surface, f), box, surface.origin, 0);
  return sum / 6;
}

} // namespace conceg::mesh
