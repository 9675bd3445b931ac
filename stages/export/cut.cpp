// SPDX-License-Identifier: BSD-3-Clause
#include "cut.hpp"

#include <map>
#include <utility>

namespace conceg::exporting {
namespace {

// The part of the surface on one side of a plane: sign * (x_axis - value) >= 0.
class PlaneCut {
public:
  PlaneCut(const Surface &whole, int axis, double value, double sign)
      : whole_(whole), axis_(axis), value_(value), sign_(sign), number_(whole.vertex.size(), unused) {}

  Surface run() {
    for (const glm::uvec3 &face : whole_.face)
      add(face);
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
    for (int k = 2; k < corners; k++)
      part_.face.emplace_back(corner[0], corner[k - 1], corner[k]);
  }

  std::uint32_t kept(std::uint32_t v) {
    if (number_[v] == unused) {
      number_[v] = static_cast<std::uint32_t>(part_.vertex.size());
      part_.vertex.push_back(whole_.vertex[v]);
    }
    return number_[v];
  }

  // The same point for both faces of an edge, and for an image of it the same point moved by whole sides, to
  // the last bit: it is the lower end, on the lattice of mesh vertices, plus a difference that all images
  // share, rounded to that lattice.
  std::uint32_t crossing(std::uint32_t p, std::uint32_t q) {
    const auto [at, fresh] =
        crossings_.try_emplace(std::minmax(p, q), static_cast<std::uint32_t>(part_.vertex.size()));
    if (fresh) {
      const bool rises = whole_.vertex[p][axis_] < whole_.vertex[q][axis_];
      const glm::dvec3 &a = whole_.vertex[rises ? p : q], &b = whole_.vertex[rises ? q : p];
      const double place = (value_ - a[axis_]) / (b[axis_] - a[axis_]);
      glm::dvec3 point = a + glm::floor((b - a) * (place * 0x1p24) + 0.5) * 0x1p-24;
      point[axis_] = value_;
      part_.vertex.push_back(point);
    }
    return at->second;
  }

  const Surface &whole_;
  const int axis_;
  const double value_, sign_;
  Surface part_;
  std::vector<std::uint32_t> number_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings_;
};

} // namespace

Surface cut_at_box(const conceg_box &box, const Surface &surface) {
  Surface part = tile(box, surface);
  for (int axis = 0; axis < 3; axis++) {
    if (!box.periodic[axis]) continue;
    part = PlaneCut(part, axis, box.lo[axis], 1.0).run();
    part = PlaneCut(part, axis, box.hi[axis], -1.0).run();
  }
  return part;
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
