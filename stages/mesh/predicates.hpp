// SPDX-License-Identifier: BSD-3-Clause
// Exact questions about triangles of doubles, answered by CGAL's kernel and Intersections_3 (the LGPL part).
#pragma once

#include <glm/vec3.hpp>

namespace conceg::mesh {

// The triangles have no vertex in common: do they meet?
bool triangles_meet(const glm::dvec3 (&a)[3], const glm::dvec3 (&b)[3]);
// a[0] == b[0]: do they meet anywhere else?
bool meet_beyond_vertex(const glm::dvec3 (&a)[3], const glm::dvec3 (&b)[3]);
// a[0] == b[0] and a[1] == b[1]: do they meet anywhere else?
bool meet_beyond_edge(const glm::dvec3 (&a)[3], const glm::dvec3 (&b)[3]);
bool on_one_line(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c);

} // namespace conceg::mesh
