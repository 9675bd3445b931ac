// SPDX-License-Identifier: BSD-3-Clause
// Figures of one triangle surface: volume, area, closed or not, pieces, genus.
#pragma once

#include "tile.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace conceg {

struct SurfaceFigures {
  double volume = 0.0, area = 0.0;      // um3, negative when wound inward; um2
  bool closed = true;                   // each edge is in two faces, once in each direction
  std::uint32_t components = 0;         // pieces joined by vertices
  std::int64_t genus = 0;               // handles of all pieces; 0 where it is not closed
  std::vector<std::uint32_t> component; // per face
};

// Volume by the divergence theorem: a sum of a . (b x c) / 6 over faces, about the first vertex.
inline SurfaceFigures measure_surface(const Surface &surface) {
  SurfaceFigures figures;
  std::vector<std::uint32_t> top(surface.vertex.size());
  std::iota(top.begin(), top.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (top[v] != v)
      v = top[v] = top[top[v]];
    return v;
  };
  std::vector<std::pair<std::uint64_t, int>> edges; // undirected edge, direction
  edges.reserve(3 * surface.face.size());
  for (const glm::uvec3 &face : surface.face) {
    const glm::dvec3 a = surface.vertex[face.x] - surface.vertex[0],
                     b = surface.vertex[face.y] - surface.vertex[0],
                     c = surface.vertex[face.z] - surface.vertex[0];
    figures.volume += glm::dot(a, glm::cross(b, c)) / 6.0;
    figures.area += 0.5 * glm::length(glm::cross(b - a, c - a));
    for (int k = 0; k < 3; k++) {
      const std::uint32_t p = face[k], q = face[(k + 1) % 3];
      edges.emplace_back(std::uint64_t(std::min(p, q)) << 32 | std::max(p, q), p < q);
      top[find(p)] = find(q);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::int64_t different = 0;
  for (std::size_t i = 0; i < edges.size(); different++) {
    std::size_t j = i;
    while (j < edges.size() && edges[j].first == edges[i].first)
      j++;
    figures.closed = figures.closed && j - i == 2 && edges[i].second != edges[i + 1].second;
    i = j;
  }
  std::vector<std::uint32_t> number(surface.vertex.size(), ~0u);
  std::vector<bool> used(surface.vertex.size(), false);
  for (const glm::uvec3 &face : surface.face) {
    const std::uint32_t root = find(face.x);
    if (number[root] == ~0u) number[root] = figures.components++;
    figures.component.push_back(number[root]);
    used[face.x] = used[face.y] = used[face.z] = true;
  }
  // Euler: V - E + F = 2 (pieces - genus).
  const std::int64_t euler =
      std::count(used.begin(), used.end(), true) - different + static_cast<std::int64_t>(surface.face.size());
  figures.closed = figures.closed && !surface.face.empty();
  if (figures.closed) figures.genus = figures.components - euler / 2;
  return figures;
}

} // namespace conceg
