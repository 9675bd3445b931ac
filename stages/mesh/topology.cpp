// SPDX-License-Identifier: BSD-3-Clause
#include "topology.hpp"
#include "predicates.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace conceg::mesh {
namespace {

class Topology {
public:
  Topology(const Surface &surface, std::uint32_t number, std::vector<Defect> &out)
      : surface_(surface), number_(number), out_(out) {}

  // False when an index is out of range or a face is degenerate, so that the pair test cannot take the
  // surface.
  bool run() {
    bool usable = true;
    for (std::uint32_t f = 0; f < surface_.face.size(); f++) {
      const glm::uvec3 &v = surface_.face[f];
      const std::size_t count = surface_.vertex.size();
      if (v.x >= count || v.y >= count || v.z >= count) {
        add(Flaw::bad_index, f, {});
        return false;
      }
      if (v.x == v.y || v.y == v.z || v.z == v.x ||
          on_one_line(surface_.at(v.x), surface_.at(v.y), surface_.at(v.z)))
        add(Flaw::degenerate_face, f, surface_.at(v.x)), usable = false;
    }
    collect_rings();
    for (std::uint32_t v = 0; v < surface_.vertex.size(); v++)
      check_ring(v);
    if (!(volume_of(surface_) > 0)) add(Flaw::inward, 0, surface_.origin);
    return usable;
  }

private:
  // One face around a vertex: it runs from `from` to `to` seen from outside.
  struct Spoke {
    std::uint32_t from, to, face;
  };

  void collect_rings() {
    start_.assign(surface_.vertex.size() + 1, 0);
    for (const glm::uvec3 &f : surface_.face)
      for (int i = 0; i < 3; i++)
        start_[f[i] + 1]++;
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    spoke_.resize(surface_.face.size() * 3);
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (std::uint32_t f = 0; f < surface_.face.size(); f++)
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
    std::size_t visited = 0;
    auto it = first;
    do {
      it = find(first, last, it->to);
      visited++;
    } while (it != first && visited <= static_cast<std::size_t>(last - first));
    if (visited != static_cast<std::size_t>(last - first)) add(Flaw::split_vertex, v, surface_.at(v));
  }

  template <class It> static It find(It first, It last, std::uint32_t from) {
    for (It it = first; it != last; ++it)
      if (it->from == from) return it;
    return last;
  }

  void add(Flaw flaw, std::uint32_t face, const glm::dvec3 &where) {
    out_.push_back({flaw, number_, face, 0, 0, {}, where});
  }

  const Surface &surface_;
  std::uint32_t number_;
  std::vector<Defect> &out_;
  std::vector<std::uint32_t> start_;
  std::vector<Spoke> spoke_;
};

} // namespace

bool check_topology(const Surface &surface, std::uint32_t number, std::vector<Defect> &out) {
  return Topology(surface, number, out).run();
}

} // namespace conceg::mesh
