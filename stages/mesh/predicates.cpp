// SPDX-License-Identifier: BSD-3-Clause
#include "predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>

namespace conceg::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point point(const glm::dvec3 &p) {
  return {p.x, p.y, p.z};
}

// Both on the same side of the plane of t, and not on it.
bool strictly_beside(const Point &t0, const Point &t1, const Point &t2, const Point &p, const Point &q) {
  const CGAL::Orientation side = CGAL::orientation(t0, t1, t2, p);
  return side != CGAL::COPLANAR && side == CGAL::orientation(t0, t1, t2, q);
}

} // namespace

bool triangles_meet(const glm::dvec3 (&a)[3], const glm::dvec3 (&b)[3]) {
  return CGAL::do_intersect(Kernel::Triangle_3(point(a[0]), point(a[1]), point(a[2])),
                            Kernel::Triangle_3(point(b[0]), point(b[1]), point(b[2])));
}

// What they share beyond the vertex is a segment from it that ends on an opposite edge of one of the two.
bool meet_beyond_vertex(const glm::dvec3 (&a)[3], const glm::dvec3 (&b)[3]) {
  const Point v = point(a[0]), a1 = point(a[1]), a2 = point(a[2]), b1 = point(b[1]), b2 = point(b[2]);
  if (strictly_beside(v, a1, a2, b1, b2) || strictly_beside(v, b1, b2, a1, a2)) return false;
  return CGAL::do_intersect(Kernel::Segment_3(a1, a2), Kernel::Triangle_3(v, b1, b2)) ||
         CGAL::do_intersect(Kernel::Segment_3(b1, b2), Kernel::Triangle_3(v, a1, a2));
}

bool meet_beyond_edge(const glm::dvec3 (&a)[3], const glm::dvec3 (&b)[3]) {
  const Point e0 = point(a[0]), e1 = point(a[1]), p = point(a[2]), q = point(b[2]);
  return CGAL::orientation(e0, e1, p, q) == CGAL::COPLANAR &&
         CGAL::coplanar_orientation(e0, e1, p, q) == CGAL::POSITIVE;
}

bool on_one_line(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c) {
  return CGAL::collinear(point(a), point(b), point(c));
}

} // namespace conceg::mesh
