// SPDX-License-Identifier: BSD-3-Clause
// Surfaces whose signals are known: spheres, cylinders that go on through the box, parallel planes.
#pragma once

#include "../walls.hpp"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace conceg::simulate::testing {

inline conceg_box cube(double side) {
  return {{0.0, 0.0, 0.0}, {side, side, side}, {1, 1, 1}};
}

// The image of a difference of places that is shortest along each axis.
inline glm::dvec3 nearest_image(const conceg_box &box, glm::dvec3 d) {
  for (int axis = 0; axis < 3; axis++) {
    const double side = conceg_box_side(&box, axis);
    d[axis] -= side * std::round(d[axis] / side);
  }
  return d;
}

inline void add_face(Membranes &m, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                     std::uint32_t cell = 0) {
  m.face.emplace_back(a, b, c), m.cell.push_back(cell), m.code.push_back(1);
}

// An icosahedron divided `rounds` times, 20 4^rounds faces, widened to the volume of the sphere.
inline void add_sphere(Membranes &m, const glm::dvec3 &centre, double radius, int rounds,
                       std::uint32_t cell = 0) {
  const double phi = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<glm::dvec3> v;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-phi, phi})
      v.insert(v.end(), {{0.0, s, t}, {s, t, 0.0}, {t, 0.0, s}});
  std::vector<std::array<std::uint32_t, 3>> f;
  for (std::uint32_t a = 0; a < 12; a++)
    for (std::uint32_t b = 0; b < 12; b++)
      for (std::uint32_t c = 0; c < 12; c++) {
        const auto edge = [&](std::uint32_t i, std::uint32_t j) {
          return std::fabs(glm::distance(v[i], v[j]) - 2.0) < 1e-9;
        };
        if (a < b && a < c && edge(a, b) && edge(b, c) && edge(c, a) &&
            glm::dot(glm::cross(v[b] - v[a], v[c] - v[a]), v[a]) > 0.0)
          f.push_back({a, b, c});
      }
  for (glm::dvec3 &p : v)
    p = glm::normalize(p);
  for (int round = 0; round < rounds; round++) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      const auto [at, added] =
          middles.insert({{std::min(i, j), std::max(i, j)}, static_cast<std::uint32_t>(v.size())});
      if (added) v.push_back(glm::normalize(v[i] + v[j]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto &[a, b, c] : f) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    f.swap(finer);
  }
  double volume = 0.0;
  for (const auto &[a, b, c] : f)
    volume += glm::dot(v[a], glm::cross(v[b], v[c])) / 6.0;
  const double scale = radius * std::cbrt(4.0 / 3.0 * M_PI / volume);
  const auto first = static_cast<std::uint32_t>(m.vertex.size());
  for (const glm::dvec3 &p : v)
    m.vertex.push_back(centre + scale * p);
  for (const auto &[a, b, c] : f)
    add_face(m, first + a, first + b, first + c, cell);
}

// A cylinder along z from one side of the box to the other, cut there, of the circle's area.
inline void add_cylinder(Membranes &m, double x, double y, double radius, double length,
                         std::uint32_t sides) {
  const double step = 2.0 * M_PI / sides, scale = radius * std::sqrt(step / std::sin(step));
  const auto first = static_cast<std::uint32_t>(m.vertex.size());
  for (std::uint32_t i = 0; i < sides; i++)
    for (const double z : {0.0, length})
      m.vertex.emplace_back(x + scale * std::cos(step * i), y + scale * std::sin(step * i), z);
  for (std::uint32_t i = 0; i < sides; i++) {
    const std::uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % sides);
    add_face(m, a, b, b + 1), add_face(m, a, b + 1, a + 1);
  }
}

// The plane at height z through the whole box.
inline void add_plane(Membranes &m, double z, double side, bool up) {
  const auto first = static_cast<std::uint32_t>(m.vertex.size());
  m.vertex.insert(m.vertex.end(), {{0.0, 0.0, z}, {side, 0.0, z}, {side, side, z}, {0.0, side, z}});
  if (up)
    add_face(m, first, first + 1, first + 2), add_face(m, first, first + 2, first + 3);
  else
    add_face(m, first, first + 2, first + 1), add_face(m, first, first + 3, first + 2);
}

} // namespace conceg::simulate::testing
