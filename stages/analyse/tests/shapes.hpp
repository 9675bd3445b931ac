// SPDX-License-Identifier: BSD-3-Clause
// Shapes with known sizes for the tests of analyse.
#pragma once

#include "../tissue.hpp"

#include <glm/geometric.hpp>

#include <map>
#include <utility>

namespace shapes {

using conceg::analyse::Cells;
using conceg::analyse::Meshes;
using conceg::analyse::Skeletons;

inline conceg_box box_of(double size, bool periodic = true) {
  conceg_box box = {};
  for (int a = 0; a < 3; a++)
    box.hi[a] = size, box.periodic[a] = periodic;
  return box;
}

// A sphere whose vertices lie on it: an icosahedron divided `rounds` times.
struct Triangles {
  std::vector<glm::dvec3> vertex;
  std::vector<std::uint32_t> face;
};

inline Triangles icosphere(int rounds) {
  const double t = 1.6180339887498949;
  Triangles s;
  s.vertex = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
              {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  s.face = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
            4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
            6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
  for (int round = 0; round < rounds; round++) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
      const auto key = std::minmax(a, b);
      const auto found = middle.find(key);
      if (found != middle.end()) return found->second;
      s.vertex.push_back(0.5 * (s.vertex[a] + s.vertex[b]));
      return middle[key] = static_cast<std::uint32_t>(s.vertex.size() - 1);
    };
    std::vector<std::uint32_t> finer;
    for (std::size_t f = 0; f < s.face.size(); f += 3) {
      const std::uint32_t a = s.face[f], b = s.face[f + 1], c = s.face[f + 2], ab = between(a, b),
                          bc = between(b, c), ca = between(c, a);
      finer.insert(finer.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
    }
    s.face = finer;
    for (glm::dvec3 &v : s.vertex)
      v = glm::normalize(v);
  }
  return s;
}

// A capped cylinder along z from 0 to `length`, or by radius_b a cut cone.
inline Triangles cylinder(double radius, double length, std::uint32_t sides) {
  Triangles s;
  s.vertex = {{0, 0, 0}, {0, 0, length}};
  for (std::uint32_t i = 0; i < sides; i++) {
    const double a = 2 * 3.14159265358979323846 * i / sides;
    s.vertex.push_back({radius * std::cos(a), radius * std::sin(a), 0});
    s.vertex.push_back({radius * std::cos(a), radius * std::sin(a), length});
  }
  for (std::uint32_t i = 0; i < sides; i++) {
    const std::uint32_t p = 2 + 2 * i, q = 2 + 2 * ((i + 1) % sides);
    s.face.insert(s.face.end(), {0, q, p, 1, p + 1, q + 1, p, q, q + 1, p, q + 1, p + 1});
  }
  return s;
}

inline void add_surface(Meshes &m, std::uint32_t cell, const Triangles &t, double scale,
                        const glm::dvec3 &at) {
  if (m.vertex_offset.empty()) m.vertex_offset.push_back(0), m.face_offset.push_back(0);
  for (const glm::dvec3 &v : t.vertex)
    m.vertex.push_back(at + scale * v);
  m.face.insert(m.face.end(), t.face.begin(), t.face.end());
  m.cell.push_back(cell);
  m.vertex_offset.push_back(m.vertex.size()), m.face_offset.push_back(m.face.size() / 3);
}

inline void add_cell(Cells &c, const glm::dvec3 &soma, float radius) {
  if (c.type_name.empty()) c.type_name = {"L4 pyramidal"}, c.type_class = {"pyramidal"};
  c.id.push_back(c.id.size()), c.type.push_back(0), c.soma.push_back(soma), c.soma_radius.push_back(radius);
}

// Adds the tree of one cell: parents are rows of the cell.
inline void add_tree(Skeletons &s, const std::vector<glm::dvec3> &position,
                     const std::vector<std::int64_t> &parent, float radius, std::uint8_t kind) {
  if (s.cell_offset.empty()) s.cell_offset.push_back(0);
  s.position.insert(s.position.end(), position.begin(), position.end());
  s.parent.insert(s.parent.end(), parent.begin(), parent.end());
  s.radius.insert(s.radius.end(), position.size(), radius),
      s.kind.insert(s.kind.end(), position.size(), kind);
  s.cell_offset.push_back(s.position.size());
}

} // namespace shapes
