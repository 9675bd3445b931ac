// SPDX-License-Identifier: BSD-3-Clause
#include "truth.hpp"

#include "guard.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numeric>
#include <unordered_map>

namespace conceg::fit {
namespace {

bool is_soma(std::uint8_t code) {
  return code == 1 || code == 19;
}

struct Border { // from a to b along a face of the soma
  std::uint32_t a, b;
};

// One surface with its vertices counted from a corner of its own, which keeps digits.
class Surface {
public:
  Surface(const Surfaces &all, std::size_t row)
      : vertex_(all.vertex + 3 * all.vertex_offset[row]), face_(all.face + 3 * all.face_offset[row]),
        code_(all.compartment + all.face_offset[row]),
        vertices_(static_cast<std::size_t>(all.vertex_offset[row + 1] - all.vertex_offset[row])),
        faces_(static_cast<std::size_t>(all.face_offset[row + 1] - all.face_offset[row])) {
    for (std::size_t i = 0; i < 3 * faces_; i++)
      if (face_[i] >= vertices_)
        fail(CONCEG_E_FORMAT, "/meshes/face: surface %zu: expected vertices below %zu, got %u", row,
             vertices_, face_[i]);
  }

  SomaVolume volume() const {
    SomaVolume out;
    for (std::size_t f = 0; f < faces_; f++) {
      const double part = flux(at(face_[3 * f]), at(face_[3 * f + 1]), at(face_[3 * f + 2]));
      out.total += part;
      if (is_soma(code_[f])) out.soma += part;
    }
    const std::vector<Border> edges = borders();
    const std::vector<glm::dvec3> center = loop_centers(edges);
    for (std::size_t i = 0; i < edges.size(); i++)
      out.soma += flux(at(edges[i].b), at(edges[i].a), center[i]);
    return out;
  }

private:
  glm::dvec3 at(std::uint32_t i) const {
    return {vertex_[3 * i] - vertex_[0], vertex_[3 * i + 1] - vertex_[1], vertex_[3 * i + 2] - vertex_[2]};
  }
  static double flux(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c) {
    return glm::dot(a, glm::cross(b, c)) / 6.0;
  }

  // Edges between the soma and the rest, as the soma's faces run along them.
  std::vector<Border> borders() const {
    std::vector<std::uint8_t> seen(vertices_, 0); // 1 touches the soma, 2 something else
    for (std::size_t f = 0; f < faces_; f++)
      for (std::size_t k = 0; k < 3; k++)
        seen[face_[3 * f + k]] |= is_soma(code_[f]) ? 1 : 2;
    std::vector<Border> soma, rest;
    for (std::size_t f = 0; f < faces_; f++)
      for (std::size_t k = 0; k < 3; k++) {
        const std::uint32_t a = face_[3 * f + k], b = face_[3 * f + (k + 1) % 3];
        if (seen[a] != 3 || seen[b] != 3) continue;
        if (is_soma(code_[f]))
          soma.push_back({a, b});
        else
          rest.push_back({b, a});
      }
    const auto before = [](const Border &x, const Border &y) { return x.a != y.a ? x.a < y.a : x.b < y.b; };
    std::sort(soma.begin(), soma.end(), before), std::sort(rest.begin(), rest.end(), before);
    std::vector<Border> out;
    std::set_intersection(soma.begin(), soma.end(), rest.begin(), rest.end(), std::back_inserter(out),
                          before);
    return out;
  }

  // For each edge the mean of the vertices of the edges that it hangs together with.
  std::vector<glm::dvec3> loop_centers(const std::vector<Border> &edges) const {
    std::unordered_map<std::uint32_t, std::uint32_t> parent;
    const auto root = [&](std::uint32_t v) {
      while (parent[v] != v)
        v = parent[v] = parent[parent[v]];
      return v;
    };
    for (const Border &e : edges)
      parent.emplace(e.a, e.a), parent.emplace(e.b, e.b);
    for (const Border &e : edges)
      parent[root(e.a)] = root(e.b);
    std::unordered_map<std::uint32_t, std::pair<glm::dvec3, double>> sum;
    for (const Border &e : edges) { // each vertex of a loop begins one of its edges
      auto &s = sum.try_emplace(root(e.a), glm::dvec3(0.0), 0.0).first->second;
      s.first += at(e.a), s.second += 1.0;
    }
    std::vector<glm::dvec3> out;
    for (const Border &e : edges) {
      const auto &s = sum[root(e.a)];
      out.push_back(s.first / s.second);
    }
    return out;
  }

  const double *vertex_;
  const std::uint32_t *face_;
  const std::uint8_t *code_;
  std::size_t vertices_, faces_;
};

} // namespace

SomaVolume soma_volume(const Surfaces &surfaces, std::size_t row) {
  return Surface(surfaces, row).volume();
}

Radii radii_of(const std::vector<double> &radius) {
  double count = 0.0, r1 = 0.0, r3 = 0.0, r4 = 0.0, r7 = 0.0;
  for (const double r : radius) {
    if (!(r > 0.0)) continue;
    const double cube = r * r * r;
    count += 1.0, r1 += r, r3 += cube, r4 += cube * r, r7 += cube * cube * r;
  }
  if (count == 0.0) return {};
  return {r1 / count, r4 / r3, std::sqrt(std::sqrt(r7 / r3))};
}

} // namespace conceg::fit
