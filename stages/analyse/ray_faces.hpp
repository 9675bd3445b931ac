// SPDX-License-Identifier: BSD-3-Clause
// Faces as rays along an axis see them. Which side of an edge a ray passes is computed on the same ordered
// edge for both of its faces, so that no ray slips between them.
#pragma once

#include "tissue.hpp"

#include <cmath>

namespace conceg::analyse {

// Across the ray u and v, along it `ray`. Edges run from the vertex with the lower index.
struct Flat {
  double u[3], v[3], ray[3];
  std::uint32_t index[3];
};

// A face of a surface, with (u, v, ray) the given axes.
inline Flat flatten(const Meshes &meshes, int u, int v, int ray, std::size_t surface, std::size_t face) {
  Flat flat;
  const glm::dvec3 *vertex = meshes.vertex.data() + meshes.vertex_offset[surface];
  for (int j = 0; j < 3; j++) {
    flat.index[j] = meshes.face[3 * face + static_cast<std::size_t>(j)];
    const glm::dvec3 &p = vertex[flat.index[j]];
    flat.u[j] = p[u], flat.v[j] = p[v], flat.ray[j] = p[ray];
  }
  return flat;
}

// Twice the area left of the edge from the lower-numbered vertex; `left` tells whether the point lies on its
// left.
inline double edge(const Flat &f, int from, int to, double u, double v, bool &left) {
  const bool swapped = f.index[from] > f.index[to];
  const int a = swapped ? to : from, b = swapped ? from : to;
  const double value = (f.u[b] - f.u[a]) * (v - f.v[a]) - (f.v[b] - f.v[a]) * (u - f.u[a]);
  left = (value >= 0) != swapped;
  return std::abs(value);
}

// +1 where a ray that runs up leaves the body, -1 where it enters, 0 where it misses the face; `at` = height.
inline int crossing(const Flat &f, double u, double v, double &at) {
  bool left[3];
  const double w2 = edge(f, 0, 1, u, v, left[0]), w0 = edge(f, 1, 2, u, v, left[1]);
  if (left[0] != left[1]) return 0;
  const double w1 = edge(f, 2, 0, u, v, left[2]);
  if (left[1] != left[2]) return 0;
  const double sum = w0 + w1 + w2;
  at = sum > 0 ? (w0 * f.ray[0] + w1 * f.ray[1] + w2 * f.ray[2]) / sum : f.ray[0];
  return left[0] ? 1 : -1;
}

} // namespace conceg::analyse
