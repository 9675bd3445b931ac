// SPDX-License-Identifier: BSD-3-Clause
// Meshes taken out of a document, to be spoiled.
#pragma once

#include "document.hpp"

namespace scenes {

// /meshes in memory, to be spoiled and written again.
struct Meshes {
  std::vector<std::uint32_t> cell, face;
  std::vector<double> origin, vertex;
  std::vector<std::uint64_t> vertex_offset, face_offset;
  glm::dvec3 at(std::size_t row, std::size_t v) const {
    const double *p = &vertex[3 * (vertex_offset[row] + v)];
    return {p[0], p[1], p[2]};
  }
  // Keeps what is written an origin plus a single-precision value.
  void move(std::size_t row, std::size_t v, const glm::dvec3 &to) {
    for (int axis = 0; axis < 3; axis++) {
      const double o = origin[3 * row + static_cast<std::size_t>(axis)];
      vertex[3 * (vertex_offset[row] + v) + static_cast<std::size_t>(axis)] = o + written(to[axis] - o);
    }
  }
  std::size_t vertices(std::size_t row) const { return vertex_offset[row + 1] - vertex_offset[row]; }
  std::uint32_t *corners(std::size_t row, std::size_t f) { return &face[3 * (face_offset[row] + f)]; }
};

template <class T> std::vector<T> copy(conceg_doc *doc, const char *path, std::size_t columns = 1) {
  const auto v = conceg::view<T>(doc, path, columns);
  return {v.begin(), v.end()};
}

inline Meshes read_meshes(conceg_doc *doc) {
  return {copy<std::uint32_t>(doc, "/meshes/cell"),
          copy<std::uint32_t>(doc, "/meshes/face", 3),
          copy<double>(doc, "/meshes/origin", 3),
          copy<double>(doc, "/meshes/vertex", 3),
          copy<std::uint64_t>(doc, "/meshes/vertex_offset"),
          copy<std::uint64_t>(doc, "/meshes/face_offset")};
}

inline std::size_t extreme(const Meshes &m, std::size_t row, double sign) {
  std::size_t best = 0;
  for (std::size_t v = 0; v < m.vertices(row); v++)
    if (sign * m.at(row, v).x > sign * m.at(row, best).x) best = v;
  return best;
}

inline void shift(Meshes &m, std::size_t row, const glm::dvec3 &by) {
  for (std::size_t v = 0; v < m.vertices(row); v++)
    m.move(row, v, m.at(row, v) + by);
}

inline void drop_row(Meshes &m, std::size_t row) {
  const auto v0 = m.vertex_offset[row], v1 = m.vertex_offset[row + 1], f0 = m.face_offset[row],
             f1 = m.face_offset[row + 1];
  const auto cut = [](auto &values, std::uint64_t first, std::uint64_t last) {
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(first),
                 values.begin() + static_cast<std::ptrdiff_t>(last));
  };
  cut(m.vertex, 3 * v0, 3 * v1), cut(m.face, 3 * f0, 3 * f1);
  cut(m.origin, 3 * row, 3 * row + 3), cut(m.cell, row, row + 1);
  cut(m.vertex_offset, row + 1, row + 2), cut(m.face_offset, row + 1, row + 2);
  for (std::size_t k = row + 1; k < m.vertex_offset.size(); k++)
    m.vertex_offset[k] -= v1 - v0, m.face_offset[k] -= f1 - f0;
}

} // namespace scenes
