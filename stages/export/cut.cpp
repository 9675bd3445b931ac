// SPDX-License-Identifier: BSD-3-Clause
#include "cut.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace conceg::exporting {
namespace {

// The part of the surface on one side of a plane: sign * (x_axis - value) >= 0.
class PlaneCut {
public:
  PlaneCut(const CutSurface &whole, int axis, double value, double sign)
      : whole_(whole), axis_(axis), value_(value), sign_(sign), number_(whole.vertex.size(), unused) {}

  CutSurface run() {
    for (std::size_t f = 0; f < whole_.face.size(); f++) {
      add(whole_.face[f]);
      part_.source_face.resize(part_.face.size(), whole_.source_face[f]);
    }
    return std::move(part_);
  }

private:
  static constexpr std::uint32_t unused = ~0u;
  double height(std::uint32_t v) const { return sign_ * (whole_.vertex[v][axis_] - value_); }

  // Sutherland and Hodgman's rule, one triangle: corners inside stay, an edge that crosses gives a point.
  void add(const glm::uvec3 &face) {
    std::uint32_t corner[4];
    int corners = 0;
    if (height(face.x) <= 0.0 && height(face.y) <= 0.0 && height(face.z) <= 0.0) return;
    for (int k = 0; k < 3; k++) {
      const std::uint32_t p = face[k], q = face[(k + 1) % 3];
      const double hp = height(p), hq = height(q);
      if (hp >= 0.0) corner[corners++] = kept(p);
      if ((hp > 0.0 && hq < 0.0) || (hp < 0.0 && hq > 0.0)) corner[corners++] = crossing(p, q);
    }
    if (corners == 4) // the diagonal does not depend on where the face begins
      std::rotate(corner, std::min_element(corner, corner + 4, [&](auto a, auto b) { return earlier(a, b); }),
                  corner + 4);
    for (int k = 2; k < corners; k++)
      if (corner[0] != corner[k - 1] && corner[k - 1] != corner[k] && corner[k] != corner[0])
        part_.face.emplace_back(corner[0], corner[k - 1], corner[k]);
  }

  bool earlier(std::uint32_t a, std::uint32_t b) const {
    const glm::dvec3 &p = part_.vertex[a], &q = part_.vertex[b];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
  }

  std::uint32_t kept(std::uint32_t v) {
    if (number_[v] == unused) {
      if (height(v) == 0.0) return number_[v] = in_plane(whole_.vertex[v]);
      number_[v] = static_cast<std::uint32_t>(part_.vertex.size());
      part_.vertex.push_back(whole_.vertex[v]);
    }
    return number_[v];
  }

  // Points of the plane that rounding brings to one place are one vertex.
  std::uint32_t in_plane(const glm::dvec3 &point) {
    const auto [at, fresh] =
        placed_.try_emplace({point.x, point.y, point.z}, static_cast<std::uint32_t>(part_.vertex.size()));
    if (fresh) part_.vertex.push_back(point);
    return at->second;
  }

  // The same point for both faces of an edge, and for an image of it the same point moved by whole sides, to
  // the last bit: it is the lower end, on the lattice of mesh vertices, plus a difference that all images
  // share, rounded to that lattice.
  std::uint32_t crossing(std::uint32_t p, std::uint32_t q) {
    const auto [at, fresh] = crossings_.try_emplace(std::minmax(p, q), unused);
    if (fresh) {
      const bool rises = whole_.vertex[p][axis_] < whole_.vertex[q][axis_];
      const glm::dvec3 &a = whole_.vertex[rises ? p : q], &b = whole_.vertex[rises ? q : p];
      const double place = (value_ - a[axis_]) / (b[axis_] - a[axis_]);
      glm::dvec3 point = a + glm::floor((b - a) * (place * 0x1p24) + 0.5) * 0x1p-24;
      point[axis_] = value_;
      at->second = in_plane(point);
    }
    return at->second;
  }

  const CutSurface &whole_;
  const int axis_;
  const double value_, sign_;
  CutSurface part_;
  std::vector<std::uint32_t> number_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings_;
  std::map<std::array<double, 3>, std::uint32_t> placed_; // vertices in the plane
};

} // namespace

namespace {

// Lids need whole rims, so an image is cut whole, not only its triangles that meet the box.
void cut_image(const conceg_box &box, const Surface &surface, const glm::dvec3 &shift, CutSurface &out) {
  CutSurface part;
  part.face = surface.face;
  for (const glm::dvec3 &p : surface.vertex)
    part.vertex.push_back(p + shift);
  for (std::uint32_t f = 0; f < surface.face.size(); f++)
    part.source_face.push_back(f);
  for (int axis = 0; axis < 3 && !part.face.empty(); axis++) {
    if (!box.periodic[axis]) continue;
    part = PlaneCut(part, axis, box.lo[axis], 1.0).run();
    part = PlaneCut(part, axis, box.hi[axis], -1.0).run();
    add_caps(part, axis, box.lo[axis], 1), add_caps(part, axis, box.hi[axis], -1);
  }
  append(out, part);
  out.source_face.insert(out.source_face.end(), part.source_face.begin(), part.source_face.end());
}

} // namespace

CutSurface cut_at_box(const conceg_box &box, const Surface &surface, bool open_sides) {
  TiledSurface tiled = tile(box, surface);
  CutSurface part;
  part.source_face = std::move(tiled.source_face);
  static_cast<Surface &>(part) = std::move(static_cast<Surface &>(tiled));
  for (int axis = 0; axis < 3; axis++) {
    if (!box.periodic[axis] && !open_sides) continue;
    part = PlaneCut(part, axis, box.lo[axis], 1.0).run();
    part = PlaneCut(part, axis, box.hi[axis], -1.0).run();
  }
  return part;
}

CutSurface capped_at_box(const conceg_box &box, const Surface &surface) {
  CutSurface out;
  if (surface.vertex.empty()) return out;
  glm::dvec3 low = surface.vertex[0], high = low;
  for (const glm::dvec3 &p : surface.vertex)
    low = glm::min(low, p), high = glm::max(high, p);
  for_each_lift(box, low, high,
                [&](const glm::ivec3 &lift) { cut_image(box, surface, glm::dvec3(lift) * side(box), out); });
  return out;
}

Surface placed(Surface surface, const glm::dvec3 &origin, double scale) {
  for (glm::dvec3 &p : surface.vertex)
    p = (p - origin) * scale;
  return surface;
}

void append(Surface &to, const Surface &surface) {
  const auto base = static_cast<std::uint32_t>(to.vertex.size());
  to.vertex.insert(to.vertex.end(), surface.vertex.begin(), surface.vertex.end());
  for (const glm::uvec3 &face : surface.face)
    to.face.push_back(face + base);
}

} // namespace conceg::exporting
