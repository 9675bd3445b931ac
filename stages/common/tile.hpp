// SPDX-License-Identifier: BSD-3-Clause
// Images in the periodic box: cells are stored unwrapped and leave the box; what fills it are their images at
// every lift (whole numbers of box sides added) at which a triangle or a segment meets the box.
#pragma once

#include "wrap.hpp"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace conceg {

// More images of one triangle or segment than this mean a broken coordinate.
inline constexpr double image_limit = 1e6;

// Calls body(lift) for every lift at which the bounds [low, high] meet the box, in ascending order.
template <class Body>
void for_each_lift(const conceg_box &box, const glm::dvec3 &low, const glm::dvec3 &high, Body &&body) {
  glm::dvec3 from(0.0), to(0.0);
  double count = 1.0;
  for (int axis = 0; axis < 3; axis++) {
    if (!box.periodic[axis]) continue;
    const double length = conceg_box_side(&box, axis);
    from[axis] = std::ceil((box.lo[axis] - high[axis]) / length);
    to[axis] = std::floor((box.hi[axis] - low[axis]) / length);
    count *= std::max(0.0, to[axis] - from[axis] + 1.0);
  }
  if (!(count <= image_limit) || !(glm::abs(from.x) + glm::abs(from.y) + glm::abs(from.z) < image_limit))
    fail(CONCEG_E_RANGE,
         "a piece of a cell reaches from (%g, %g, %g) to (%g, %g, %g) um: expected it near the box", low.x,
         low.y, low.z, high.x, high.y, high.z);
  for (int x = static_cast<int>(from.x); x <= static_cast<int>(to.x); x++)
    for (int y = static_cast<int>(from.y); y <= static_cast<int>(to.y); y++)
      for (int z = static_cast<int>(from.z); z <= static_cast<int>(to.z); z++)
        body(glm::ivec3(x, y, z));
}

// A triangle surface without its document: vertices in um and faces of local vertex numbers.
struct Surface {
  std::vector<glm::dvec3> vertex;
  std::vector<glm::uvec3> face;
};

// The images of a surface in the box: every whole triangle that meets it, with the vertex and the face that
// each came from.
struct TiledSurface : Surface {
  std::vector<std::uint32_t> source_vertex, source_face;
};

inline TiledSurface tile(const conceg_box &box, const Surface &surface) {
  struct Image {
    glm::ivec3 lift;
    std::uint32_t face;
  };
  std::vector<Image> images;
  images.reserve(surface.face.size() + surface.face.size() / 4);
  for (std::uint32_t f = 0; f < surface.face.size(); f++) {
    const glm::dvec3 &a = surface.vertex[surface.face[f].x], &b = surface.vertex[surface.face[f].y],
                     &c = surface.vertex[surface.face[f].z];
    for_each_lift(box, glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)), [&](const glm::ivec3 &at) {
      images.push_back({at, f});
    });
  }
  std::sort(images.begin(), images.end(), [](const Image &p, const Image &q) {
    if (p.lift.x != q.lift.x) return p.lift.x < q.lift.x;
    if (p.lift.y != q.lift.y) return p.lift.y < q.lift.y;
    if (p.lift.z != q.lift.z) return p.lift.z < q.lift.z;
    return p.face < q.face;
  });
  TiledSurface tiled;
  const glm::dvec3 sides = side(box);
  constexpr std::uint32_t unused = ~0u;
  std::vector<std::uint32_t> number(surface.vertex.size(), unused);
  std::size_t group_vertex = 0;
  for (std::size_t i = 0; i < images.size(); i++) {
    if (i > 0 && images[i].lift != images[i - 1].lift) {
      for (std::size_t v = group_vertex; v < tiled.source_vertex.size(); v++)
        number[tiled.source_vertex[v]] = unused;
      group_vertex = tiled.source_vertex.size();
    }
    glm::uvec3 face(0u);
    for (int k = 0; k < 3; k++) {
      const std::uint32_t source = surface.face[images[i].face][k];
      if (number[source] == unused) {
        number[source] = static_cast<std::uint32_t>(tiled.vertex.size());
        tiled.vertex.push_back(surface.vertex[source] + glm::dvec3(images[i].lift) * sides);
        tiled.source_vertex.push_back(source);
      }
      face[k] = number[source];
    }
    tiled.face.push_back(face);
    tiled.source_face.push_back(images[i].face);
  }
  return tiled;
}

} // namespace conceg
