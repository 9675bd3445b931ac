// SPDX-License-Identifier: BSD-3-Clause
// A triangle surface of one cell: coordinates relative to an origin on the lattice, held as the values that
// are written. A view borrows the arrays of a surface, wherever they lie: in memory, in a file, in a
// document.
#pragma once

#include "conceg/geom.h"

#include <glm/vec3.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace conceg::mesh {

struct Surface {
  std::uint32_t cell = 0;
  glm::dvec3 origin{};           // um, on the lattice
  std::vector<glm::vec3> vertex; // um, relative to origin
  std::vector<glm::uvec3> face;  // outward
  std::vector<float> room;       // um from each vertex to the nearest other label; empty when not known
  glm::dvec3 at(std::uint32_t i) const { return origin + glm::dvec3(vertex[i]); }
};

struct SurfaceView {
  std::uint32_t cell = 0;
  glm::dvec3 origin{};
  const glm::vec3 *relative = nullptr;  // um from the origin, or
  const glm::dvec3 *absolute = nullptr; // um
  const glm::uvec3 *face = nullptr;
  std::size_t vertices = 0, faces = 0;
  SurfaceView() = default;
  SurfaceView(const Surface &s)
      : cell(s.cell), origin(s.origin), relative(s.vertex.data()), face(s.face.data()),
        vertices(s.vertex.size()), faces(s.face.size()) {}
  glm::dvec3 at(std::uint32_t i) const { return absolute ? absolute[i] : origin + glm::dvec3(relative[i]); }
  glm::dvec3 from_origin(std::uint32_t i) const {
    return absolute ? absolute[i] - origin : glm::dvec3(relative[i]);
  }
};
using Views = std::vector<SurfaceView>;

inline Views views_of(const std::vector<Surface> &surfaces) {
  return Views(surfaces.begin(), surfaces.end());
}

// A relative coordinate as it is written: a float32 that is a multiple of 2^-24 um, so that origin + value
// and value +- side are exact in double precision.
inline float written(double relative) {
  return static_cast<float>(std::floor(relative * 0x1p24 + 0.5) * 0x1p-24);
}
inline glm::vec3 written(const glm::dvec3 &p) {
  return {written(p.x), written(p.y), written(p.z)};
}

inline glm::dvec3 cross_product(const glm::dvec3 &a, const glm::dvec3 &b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Enclosed volume and area, um3 and um2.
double volume_of(const SurfaceView &surface);
double area_of(const SurfaceView &surface);
// Volume of the part inside the box (open axes cut it exactly; periodic axes do not).
double volume_inside(const SurfaceView &surface, const conceg_box &box);

} // namespace conceg::mesh
