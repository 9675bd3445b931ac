// SPDX-License-Identifier: BSD-3-Clause
#include "components.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <numeric>

namespace conceg::mesh {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t> &up, std::uint32_t v) {
  while (up[v] != v)
    v = up[v] = up[up[v]];
  return v;
}

struct Piece {
  double volume = 0;
  bool holds = false; // an odd number of its faces lie on the ray from the point along +x
};

// Does the ray from p along +x meet the face? Half-open rule in the yz plane, so that shared edges count
// once.
bool on_ray(const Surface &surface, const glm::uvec3 &f, const glm::dvec3 &p) {
  const glm::dvec3 t[3] = {surface.vertex[f.x], surface.vertex[f.y], surface.vertex[f.z]};
  const bool above[3] = {t[0].z > p.z, t[1].z > p.z, t[2].z > p.z};
  if (above[0] == above[1] && above[1] == above[2]) return false;
  bool inside = false;
  for (int i = 0, j = 2; i < 3; j = i++)
    if (above[i] != above[j] && p.y < t[i].y + (p.z - t[i].z) * (t[j].y - t[i].y) / (t[j].z - t[i].z))
      inside = !inside;
  if (!inside) return false;
  const glm::dvec3 normal = cross_product(t[1] - t[0], t[2] - t[0]);
  return normal.x != 0 && t[0].x + ((t[0].y - p.y) * normal.y + (t[0].z - p.z) * normal.z) / normal.x > p.x;
}

void keep_faces(Surface &surface, std::vector<std::uint32_t> &up, std::uint32_t kept) {
  std::vector<glm::uvec3> face;
  for (const glm::uvec3 &f : surface.face)
    if (root_of(up, f.x) == kept) face.push_back(f);
  std::vector<std::uint32_t> number(surface.vertex.size());
  std::vector<glm::vec3> vertex;
  std::vector<float> room;
  for (std::uint32_t v = 0; v < surface.vertex.size(); v++)
    if (root_of(up, v) == kept) {
      number[v] = static_cast<std::uint32_t>(vertex.size()), vertex.push_back(surface.vertex[v]);
      if (!surface.room.empty()) room.push_back(surface.room[v]);
    }
  for (glm::uvec3 &f : face)
    f = {number[f.x], number[f.y], number[f.z]};
  surface.face.swap(face);
  surface.vertex.swap(vertex);
  surface.room.swap(room);
}

} // namespace

Pieces keep_soma_piece(Surface &surface, const glm::dvec3 &inside, bool has_soma) {
  Pieces result;
  if (surface.face.empty()) return result;
  std::vector<std::uint32_t> up(surface.vertex.size());
  std::iota(up.begin(), up.end(), 0u);
  for (const glm::uvec3 &f : surface.face)
    for (const std::uint32_t v : {f.y, f.z}) {
      const std::uint32_t a = root_of(up, f.x), b = root_of(up, v);
      up[std::max(a, b)] = std::min(a, b);
    }
  std::vector<Piece> piece(surface.vertex.size()); // used at roots only
  for (const glm::uvec3 &f : surface.face) {
    Piece &p = piece[root_of(up, f.x)];
    p.volume += glm::dot(glm::dvec3(surface.vertex[f.x]),
                         cross_product(glm::dvec3(surface.vertex[f.y]), glm::dvec3(surface.vertex[f.z]))) /
                6;
    if (on_ray(surface, f, inside)) p.holds = !p.holds;
  }
  std::int64_t holder = -1, largest = -1;
  for (std::uint32_t v = 0; v < piece.size(); v++) {
    if (up[v] != v) continue;
    if (largest < 0 || piece[v].volume > piece[static_cast<std::size_t>(largest)].volume) largest = v;
    if (piece[v].holds && piece[v].volume > 0 &&
        (holder < 0 || piece[v].volume < piece[static_cast<std::size_t>(holder)].volume))
      holder = v;
  }
  result.soma_found = !has_soma || holder >= 0;
  const auto kept = static_cast<std::uint32_t>(has_soma && holder >= 0 ? holder : largest);
  std::uint32_t others = 0;
  for (std::uint32_t v = 0; v < piece.size(); v++) {
    if (up[v] != v || v == kept) continue;
    others++;
    if (piece[v].volume > 0)
      result.detached++, result.detached_volume += piece[v].volume;
    else
      result.cavities++, result.cavity_volume -= piece[v].volume;
  }
  if (others) keep_faces(surface, up, kept);
  return result;
}

std::int64_t euler_characteristic(const SurfaceView &surface) {
  // Closed: every edge belongs to two faces.
  return static_cast<std::int64_t>(surface.vertices) - static_cast<std::int64_t>(surface.faces) / 2;
}

} // namespace conceg::mesh
