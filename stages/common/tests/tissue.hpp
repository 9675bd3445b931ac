// SPDX-License-Identifier: BSD-3-Clause
// A tiny tissue for tests of the stages that only read: three cells in a periodic box of 20 um, each a ball
// with one forked neurite; the second ball crosses a corner of the box and the first neurite a side.
#pragma once

#include "tile.hpp"
#include "view.hpp"

#include <glm/geometric.hpp>

#include <map>
#include <utility>
#include <vector>

namespace conceg::testing {

inline constexpr double box_side = 20.0;
inline const glm::dvec3 centres[3] = {{10, 9, 8}, {0.5, 19.5, 0.25}, {14, 3, 15}};
inline const double radii[3] = {4.0, 3.0, 2.0};

// A unit icosphere of 20 * 4^level outward triangles.
inline Surface icosphere(int level) {
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  Surface ball;
  for (int axis = 0; axis < 3; axis++)
    for (int k = 0; k < 4; k++) {
      glm::dvec3 p(0.0);
      p[axis] = k % 2 ? 1.0 : -1.0, p[(axis + 1) % 3] = k < 2 ? golden : -golden;
      ball.vertex.push_back(glm::normalize(p));
    }
  ball.face = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
               {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
               {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int pass = 0; pass < level; pass++) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(ball.vertex.size()));
      if (fresh) ball.vertex.push_back(glm::normalize(ball.vertex[a] + ball.vertex[b]));
      return at->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3 &f : ball.face) {
      const std::uint32_t ab = middle(f.x, f.y), bc = middle(f.y, f.z), ca = middle(f.z, f.x);
      finer.insert(finer.end(), {{f.x, ab, ca}, {f.y, bc, ab}, {f.z, ca, bc}, {ab, bc, ca}});
    }
    ball.face = finer;
  }
  return ball;
}

inline Surface moved(Surface surface, const glm::dvec3 &centre, double radius) {
  for (glm::dvec3 &p : surface.vertex)
    p = centre + radius * p;
  return surface;
}

inline void put_domain(conceg_doc *doc, bool periodic = true) {
  const double lo[3] = {0, 0, 0}, hi[3] = {box_side, box_side, box_side}, pia[3] = {0, 0, 1};
  const std::uint8_t wraps[3] = {periodic, periodic, periodic};
  put(doc, "/domain@lo", lo, 3);
  put(doc, "/domain@hi", hi, 3);
  put(doc, "/domain@periodic", wraps, 3);
  put(doc, "/domain@pia", pia, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
}

inline void put_cells(conceg_doc *doc) {
  put_texts(doc, "/types/name", {"L2/3 pyramidal", "L4 interneuron", "astrocyte"});
  put_texts(doc, "/types/class", {"pyramidal", "interneuron", "astrocyte"});
  put_texts(doc, "/types/layer", {"2/3", "4", ""});
  put(doc, "/cells/id", std::vector<std::uint64_t>{10, 20, 30});
  put(doc, "/cells/type", std::vector<std::uint32_t>{0, 1, 2});
  put3(doc, "/cells/soma", std::vector<glm::dvec3>(centres, centres + 3));
  put(doc, "/cells/radius", std::vector<float>{4, 3, 2});
}

// Each cell: from the surface of its soma 3 um along +x, then a fork of two branches of 4 um.
inline constexpr int points_per_cell = 6;
inline void put_skeleton(conceg_doc *doc) {
  std::vector<glm::dvec3> position;
  std::vector<std::int64_t> parent;
  for (int cell = 0; cell < 3; cell++) {
    const glm::dvec3 root = centres[cell] + glm::dvec3(radii[cell], 0, 0), fork = root + glm::dvec3(3, 0, 0);
    const std::vector<glm::dvec3> points = {root,
                                            fork,
                                            fork + glm::dvec3(1, 1, 0),
                                            fork + glm::dvec3(3, 3, 0),
                                            fork + glm::dvec3(1, -1, 0),
                                            fork + glm::dvec3(3, -3, 1)};
    position.insert(position.end(), points.begin(), points.end());
    parent.insert(parent.end(), {-1, 0, 1, 2, 1, 4});
  }
  const std::size_t count = position.size();
  std::vector<std::uint32_t> branch, zero(count, 0);
  for (int cell = 0; cell < 3; cell++)
    branch.insert(branch.end(), {0, 0, 1, 1, 2, 2});
  put(doc, "/skeleton/cell_offset", std::vector<std::uint64_t>{0, 6, 12, 18});
  put3(doc, "/skeleton/position", position);
  put(doc, "/skeleton/radius", std::vector<float>(count, 0.5f));
  put(doc, "/skeleton/target_radius", std::vector<float>(count, 0.625f));
  put(doc, "/skeleton/parent", parent);
  put(doc, "/skeleton/kind", std::vector<std::uint8_t>(count, 3));
  put(doc, "/skeleton/branch", branch);
  put(doc, "/skeleton/bar", zero);
  put(doc, "/skeleton/tree", zero);
  put(doc, "/skeleton/status", std::vector<std::uint8_t>(count, 1));
}

inline void put_meshes(conceg_doc *doc, int level = 3) {
  const Surface ball = icosphere(level);
  std::vector<glm::dvec3> vertex;
  std::vector<std::uint32_t> face;
  std::vector<std::uint64_t> vertex_offset = {0}, face_offset = {0};
  for (int cell = 0; cell < 3; cell++) {
    const Surface own = moved(ball, centres[cell], radii[cell]);
    vertex.insert(vertex.end(), own.vertex.begin(), own.vertex.end());
    for (const glm::uvec3 &f : own.face)
      face.insert(face.end(), {f.x, f.y, f.z});
    vertex_offset.push_back(vertex.size()), face_offset.push_back(face.size() / 3);
  }
  std::vector<std::uint32_t> section(face.size() / 3);
  for (std::size_t i = 0; i < section.size(); i++)
    section[i] = static_cast<std::uint32_t>(i % 5);
  put(doc, "/meshes/cell", std::vector<std::uint32_t>{0, 1, 2});
  put3(doc, "/meshes/origin", std::vector<glm::dvec3>(centres, centres + 3));
  put(doc, "/meshes/vertex_offset", vertex_offset);
  put(doc, "/meshes/face_offset", face_offset);
  put3(doc, "/meshes/vertex", vertex);
  put(doc, "/meshes/face", face, 3);
  put(doc, "/meshes/compartment", std::vector<std::uint8_t>(section.size(), 1));
  put(doc, "/meshes/component", std::vector<std::uint32_t>(section.size(), 0));
  put(doc, "/meshes/section", section);
}

} // namespace conceg::testing
