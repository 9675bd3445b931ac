// SPDX-License-Identifier: BSD-3-Clause
#include "volumes.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace conceg::analyse {

namespace {

struct Polygon {
  std::array<glm::dvec3, 16> corner;
  int corners = 0;
};

// The part of a polygon with sign * (x[axis] - limit) >= 0.
Polygon clip(const Polygon &in, int axis, double limit, double sign) {
  Polygon out;
  for (int i = 0; i < in.corners; i++) {
    const glm::dvec3 &p = in.corner[static_cast<std::size_t>(i)],
                     &q = in.corner[static_cast<std::size_t>((i + 1) % in.corners)];
    const double dp = sign * (p[axis] - limit), dq = sign * (q[axis] - limit);
    if (dp >= 0) out.corner[static_cast<std::size_t>(out.corners++)] = p;
    if ((dp >= 0) != (dq >= 0))
      out.corner[static_cast<std::size_t>(out.corners++)] = p + (q - p) * (dp / (dp - dq));
  }
  return out;
}

// Area vector of the polygon, and the integral of x[axis] over it times its component along the axis.
glm::dvec3 area_vector(const Polygon &p, int axis, double &moment) {
  glm::dvec3 sum(0);
  moment = 0;
  for (int i = 1; i + 1 < p.corners; i++) {
    const glm::dvec3 &a = p.corner[0], &b = p.corner[static_cast<std::size_t>(i)],
                     &c = p.corner[static_cast<std::size_t>(i + 1)];
    const glm::dvec3 part = 0.5 * glm::cross(b - a, c - a);
    sum += part;
    moment += part[axis] * (a[axis] + b[axis] + c[axis]) / 3;
  }
  return sum;
}

// div (clamp(x), 0, 0) = 1 between the faces of the open axis x and 0 outside; on the other open axes the
// triangle is clipped, which leaves no flux through the cut. So the volume in the box is the flux of clamp(x
// - origin) through what remains.
void add_clipped(const conceg_box &box, int axis, Polygon triangle, const glm::dvec3 &origin, Size &size) {
  for (int other = 0; other < 3; other++) {
    if (other == axis || box.periodic[other]) continue;
    triangle = clip(triangle, other, box.lo[other], 1);
    triangle = clip(triangle, other, box.hi[other], -1);
  }
  double moment;
  if (!triangle.corners) return;
  if (box.periodic[axis]) {
    const glm::dvec3 area = area_vector(triangle, axis, moment);
    size.volume += moment - origin[axis] * area[axis], size.area += glm::length(area);
    return;
  }
  const Polygon from_lo = clip(triangle, axis, box.lo[axis], 1);
  const glm::dvec3 below = area_vector(clip(triangle, axis, box.lo[axis], -1), axis, moment);
  size.volume += (box.lo[axis] - origin[axis]) * below[axis];
  const glm::dvec3 above = area_vector(clip(triangle, axis, box.hi[axis], 1), axis, moment);
  size.volume += (box.hi[axis] - origin[axis]) * above[axis];
  const glm::dvec3 inside = area_vector(clip(from_lo, axis, box.hi[axis], -1), axis, moment);
  size.volume += moment - origin[axis] * inside[axis], size.area += glm::length(inside);
}

} // namespace

std::vector<Size> surface_sizes(const Meshes &meshes, const conceg_box &box, Workers &workers) {
  int axis = 0; // an open one if there is one
  for (int a = 0; a < 3; a++)
    if (!box.periodic[a]) axis = a;
  std::vector<Size> sizes(meshes.cell.size());
  std::vector<double> whole(meshes.cell.size(), 0);
  workers.loop(sizes.size(), 1, [&](std::size_t k, unsigned) {
    const glm::dvec3 *vertex = meshes.vertex.data() + meshes.vertex_offset[k];
    for (std::size_t f = meshes.face_offset[k]; f < meshes.face_offset[k + 1]; f++) {
      Polygon triangle;
      for (std::size_t j = 0; j < 3; j++)
        triangle.corner[j] = vertex[meshes.face[3 * f + j]];
      triangle.corners = 3;
      const glm::dvec3 a = triangle.corner[0] - vertex[0], b = triangle.corner[1] - vertex[0],
                       c = triangle.corner[2] - vertex[0];
      whole[k] += glm::dot(a, glm::cross(b, c)) / 6;
      add_clipped(box, axis, triangle, vertex[0], sizes[k]);
    }
  });
  for (std::size_t k = 0; k < sizes.size(); k++)
    if (!(whole[k] >= 0))
      fail(CONCEG_E_FORMAT,
           "/meshes/face: surface %zu (cell %u): expected faces that point outward, got the volume %g um3; "
           "turn its faces",
           k, meshes.cell[k], whole[k]);
  return sizes;
}

} // namespace conceg::analyse
