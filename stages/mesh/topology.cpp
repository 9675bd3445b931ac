// SPDX-License-Identifier: BSD-3-Clause
#include "topology.hpp"
#include "predicates.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace conceg::mesh {
namespace {

// Coordinates are multiples of 2^-24 um, so differences are exact and a cross product is off by 1e-15 of its
// factors at most: far below these.
constexpr double kClearlyApart = 1e-9;
constexpr double kClearlyWide = 1e-12;

class Topology {
public:
  Topology(const SurfaceView &surface, std::uint32_t number, std::vector<Defect> &out, Bits &plain)
      : surface_(surface), number_(number), out_(out), plain_(plain) {}

  bool run() {
    bool usable = true;
    for (std::uint32_t f = 0; f < surface_.faces; f++) {
      const glm::uvec3 &v = surface_.face[f];
      const std::size_t count = surface_.vertices;
      if (v.x >= count || v.y >= count || v.z >= count) {
        add(Flaw::bad_index, f, surface_.origin);
        return false;
      }
      if (is_degenerate(v)) add(Flaw::degenerate_face, f, surface_.at(v.x)), usable = false;
    }
    collect_rings();
    plain_.reset(surface_.vertices);
    for (std::uint32_t v = 0; v < surface_.vertices; v++)
      check_ring(v);
    if (!(volume_of(surface_) > 0)) add(Flaw::inward, 0, surface_.origin);
    return usable;
  }

private:
  // One face around a vertex: it runs from `from` to `to` seen from outside.
  struct Spoke {
    std::uint32_t from, to, face;
  };

  bool is_degenerate(const glm::uvec3 &v) const {
    if (v.x == v.y || v.y == v.z || v.z == v.x) return true;
    const glm::dvec3 a = surface_.at(v.x), b = surface_.at(v.y), c = surface_.at(v.z), e = b - a, f = c - a,
                     n = cross_product(e, f);
    if (glm::dot(n, n) > kClearlyWide * kClearlyWide * glm::dot(e, e) * glm::dot(f, f)) return false;
    return on_one_line(a, b, c);
  }

  void collect_rings() {
    start_.assign(surface_.vertices + 1, 0);
    for (std::size_t f = 0; f < surface_.faces; f++)
      for (int i = 0; i < 3; i++)
        start_[surface_.face[f][i] + 1]++;
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    spoke_.resize(surface_.faces * 3);
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (std::uint32_t f = 0; f < surface_.faces; f++)
      for (int i = 0; i < 3; i++) {
        const glm::uvec3 &v = surface_.face[f];
        spoke_[next[v[i]]++] = {v[(i + 1) % 3], v[(i + 2) % 3], f};
      }
  }

  // A manifold vertex: each neighbour begins one spoke and ends one, and following them visits all.
  void check_ring(std::uint32_t v) {
    const auto first = spoke_.begin() + start_[v], last = spoke_.begin() + start_[v + 1];
    if (first == last) return add(Flaw::unused_vertex, v, surface_.at(v));
    std::sort(first, last, [](const Spoke &l, const Spoke &r) {
      return std::tie(l.from, l.face) < std::tie(r.from, r.face);
    });
    bool sound = true;
    for (auto it = first; it != last; ++it) {
      if (it != first && (it - 1)->from == it->from)
        add(Flaw::turned_face, it->face, surface_.at(v)), sound = false;
      const auto next = find(first, last, it->to);
      if (next == last)
        add(Flaw::open_edge, it->face, 0.5 * (surface_.at(v) + surface_.at(it->to))), sound = false;
    }
    if (!sound) return;
    ring_.clear();
    auto it = first;
    do {
      ring_.push_back(surface_.at(it->from) - surface_.at(v));
      it = find(first, last, it->to);
    } while (it != first && ring_.size() <= static_cast<std::size_t>(last - first));
    if (ring_.size() != static_cast<std::size_t>(last - first))
      add(Flaw::split_vertex, v, surface_.at(v));
    else if (ring_is_plain())
      plain_.set(v);
  }

  // Seen along the sum of the faces' normals every face turns the same way, and together they go round once.
  bool ring_is_plain() {
    const std::size_t count = ring_.size();
    normal_.resize(count);
    glm::dvec3 view(0);
    for (std::size_t i = 0; i < count; i++)
      view += normal_[i] = cross_product(ring_[i], ring_[(i + 1) % count]);
    const double length = glm::length(view);
    if (!(length > 0)) return false;
    view /= length;
    for (std::size_t i = 0; i < count; i++)
      if (!(glm::dot(normal_[i], view) >
            kClearlyApart * glm::length(ring_[i]) * glm::length(ring_[(i + 1) % count])))
        return false;
    const glm::dvec3 other = std::fabs(view.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0),
                     upward = cross_product(view, other);
    int rounds =
        0; // each face turns by less than half a round, so it passes the half-line below -> above once
    for (std::size_t i = 0; i < count; i++)
      rounds += glm::dot(ring_[i], upward) < 0 && glm::dot(ring_[(i + 1) % count], upward) >= 0;
    return rounds == 1;
  }

  template <class It> static It find(It first, It last, std::uint32_t from) {
    for (It it = first; it != last; ++it)
      if (it->from == from) return it;
    return last;
  }

  void add(Flaw flaw, std::uint32_t face, const glm::dvec3 &where) {
    out_.push_back({flaw, number_, face, 0, 0, {}, where});
  }

  const SurfaceView &surface_;
  std::uint32_t number_;
  std::vector<Defect> &out_;
  Bits &plain_;
  std::vector<std::uint32_t> start_;
  std::vector<Spoke> spoke_;
  std::vector<glm::dvec3> ring_, normal_;
};

} // namespace

bool check_topology(const SurfaceView &surface, std::uint32_t number, std::vector<Defect> &out, Bits &plain) {
  return Topology(surface, number, out, plain).run();
}

} // namespace conceg::mesh
