// SPDX-License-Identifier: BSD-3-Clause
#include "extracellular.hpp"
#include "region.hpp"

#include "guard.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace conceg::exporting {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
constexpr std::uint32_t kNone = ~0u;

std::int64_t fixed(double x) {
  return static_cast<std::int64_t>(std::floor(x * 0x1p24 + 0.5));
}

[[noreturn]] void refuse(const char *what, const glm::dvec3 &at) {
  fail(CONCEG_E_UNSUPPORTED, "extracellular: %s at (%g, %g, %g) um", what, at.x, at.y, at.z);
}

// Closes the six sides of the box.
class Sides {
public:
  Sides(const conceg_box &box, Surface &surface) : box_(box), surface_(surface) {
    corner_.fill(kNone), state_.fill(-1);
  }

  void run() {
    for (int side = 0; side < 6; side++)
      find_rims(side);
    for (int side = 0; side < 6; side++)
      rims_tell_corners(side);
    settle_corners();
    for (int side = 0; side < 6; side++)
      cover(side);
    check_closed();
  }

private:
  struct Crossing { // of a rim and the border of its side
    int border;     // 0 .. 3 anticlockwise
    double along;   // rises in that direction
    std::uint32_t vertex;
    bool space_before;
  };

  double value(int side) const { return side % 2 ? box_.hi[side / 2] : box_.lo[side / 2]; }
  static int u_axis(int side) { return (side / 2 + 1) % 3; }
  static int v_axis(int side) { return (side / 2 + 2) % 3; }
  bool lies_in(std::uint32_t vertex, int side) const {
    return surface_.vertex[vertex][side / 2] == value(side);
  }

  // Edges in the side that have one face. Seen from above (+axis) the space's part of the side is to their
  // left.
  void find_rims(int side) {
    std::vector<Edge> edges;
    for (const glm::uvec3 &f : surface_.face)
      for (int k = 0; k < 3; k++)
        if (lies_in(f[k], side) && lies_in(f[(k + 1) % 3], side)) edges.emplace_back(f[k], f[(k + 1) % 3]);
    std::sort(edges.begin(), edges.end());
    for (const Edge &edge : edges) {
      const Edge back(edge.second, edge.first);
      if (std::binary_search(edges.begin(), edges.end(), back)) continue;
      rim_[side].push_back(side % 2 ? back : edge);
    }
    for (const Edge &edge : rim_[side])
      balance_[side][edge.first]++, balance_[side][edge.second]--;
  }

  // Where rims end the border of the side takes over: it goes on from where one arrives, and leads to where
  // one leaves.
  void find_crossings(int side) {
    const double lo_u = box_.lo[u_axis(side)], hi_u = box_.hi[u_axis(side)], lo_v = box_.lo[v_axis(side)],
                 hi_v = box_.hi[v_axis(side)];
    for (const auto &[vertex, balance] : balance_[side]) {
      if (balance == 0) continue;
      const glm::dvec3 &p = surface_.vertex[vertex];
      const double u = p[u_axis(side)], v = p[v_axis(side)];
      const int borders = (v == lo_v) + (u == hi_u) + (v == hi_v) + (u == lo_u);
      if (borders == 0) refuse("an open rim, or two that touch,", p);
      if (borders == 2 || balance < -1 || balance > 1)
        refuse("a cell's surface runs through a corner of the box, or two touch,", p);
      if (v == lo_v)
        crossing_[side].push_back({0, u, vertex, balance > 0});
      else if (u == hi_u)
        crossing_[side].push_back({1, v, vertex, balance > 0});
      else if (v == hi_v)
        crossing_[side].push_back({2, -u, vertex, balance > 0});
      else
        crossing_[side].push_back({3, -v, vertex, balance > 0});
    }
    auto &all = crossing_[side];
    std::sort(all.begin(), all.end(), [](const Crossing &l, const Crossing &r) {
      return l.border != r.border ? l.border < r.border : l.along < r.along;
    });
    for (std::size_t i = 0; i < all.size(); i++)
      if (all[i].space_before == all[(i + 1) % all.size()].space_before)
        refuse("cells meet on an edge of the box", surface_.vertex[all[i].vertex]);
  }

  // Corner k of a side, anticlockwise: where border k begins. A corner of the box has bit `axis` for its hi.
  int corner_of(int side, int k) const {
    const int u = k == 1 || k == 2, v = k >= 2;
    return (side % 2) << (side / 2) | u << u_axis(side) | v << v_axis(side);
  }

  void rims_tell_corners(int side) {
    find_crossings(side);
    const auto &all = crossing_[side];
    if (all.empty()) return;
    for (int k = 0; k < 4; k++) { // the first crossing from border k on
      const auto next =
          std::find_if(all.begin(), all.end(), [&](const Crossing &c) { return c.border >= k; });
      set_state(corner_of(side, k), (next == all.end() ? all.front() : *next).space_before);
    }
  }

  void set_state(int corner, bool space) {
    if (state_[corner] == !space) refuse("cells meet at a corner of the box", place_of(corner));
    state_[corner] = space;
  }

  glm::dvec3 place_of(int corner) const {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; axis++)
      p[axis] = corner >> axis & 1 ? box_.hi[axis] : box_.lo[axis];
    return p;
  }

  // All corners of a side without crossings are alike.
  void settle_corners() {
    const auto spread = [&] {
      for (int round = 0; round < 6; round++)
        for (int side = 0; side < 6; side++)
          for (int k = 0; crossing_[side].empty() && k < 4; k++)
            if (state_[corner_of(side, k)] >= 0)
              for (int other = 0; other < 4; other++)
                set_state(corner_of(side, other), state_[corner_of(side, k)] > 0);
    };
    spread();
    for (int corner = 0; corner < 8; corner++)
      if (state_[corner] < 0) set_state(corner, is_space(corner)), spread();
  }

  // The first face on a way into the box: the space's surface is met from behind by who comes out of the
  // space. A way that meets none tells nothing; where no way meets one there is but space.
  bool is_space(int corner) const {
    const glm::dvec3 from = place_of(corner), across = place_of(7 - corner) - from;
    for (const glm::dvec3 &lean : {glm::dvec3(1, 0.8137, 0.6193), glm::dvec3(0.4871, 1, 0.7307),
                                   glm::dvec3(0.5519, 0.3331, 1), glm::dvec3(0.9127, 0.9371, 0.9713)}) {
      const int met = first_met(from, across * lean);
      if (met) return met > 0;
    }
    return true;
  }

  // 1 when the first face on the way shows its back, -1 its front, 0 when there is none.
  int first_met(const glm::dvec3 &from, const glm::dvec3 &way) const {
    double first = INFINITY;
    int met = 0;
    for (const glm::uvec3 &f : surface_.face) {
      const glm::dvec3 a = surface_.vertex[f.x] - from, b = surface_.vertex[f.y] - from,
                       c = surface_.vertex[f.z] - from;
      const double ab = glm::dot(glm::cross(a, b), way), bc = glm::dot(glm::cross(b, c), way),
                   ca = glm::dot(glm::cross(c, a), way);
      const bool back = ab > 0 && bc > 0 && ca > 0, front = ab < 0 && bc < 0 && ca < 0;
      if (!front && !back) continue;
      const glm::dvec3 normal = glm::cross(b - a, c - a);
      const double t = glm::dot(a, normal) / glm::dot(way, normal);
      if (t > 0 && t < first) first = t, met = back ? 1 : -1;
    }
    return met;
  }

  std::uint32_t vertex_of(int corner) {
    if (corner_[corner] == kNone) {
      corner_[corner] = static_cast<std::uint32_t>(surface_.vertex.size());
      surface_.vertex.push_back(place_of(corner));
    }
    return corner_[corner];
  }

  // The parts of the border that lie in the space, cut at crossings and corners.
  void add_border(int side, std::vector<Edge> &edges) {
    std::vector<std::pair<std::uint32_t, bool>> stop; // with: is what comes before it space?
    auto next = crossing_[side].begin();
    const auto end = crossing_[side].end();
    for (int k = 0; k < 4; k++) {
      const int corner = corner_of(side, k);
      stop.emplace_back(state_[corner] > 0 ? vertex_of(corner) : kNone, state_[corner] > 0);
      for (; next != end && next->border == k; ++next)
        stop.emplace_back(next->vertex, next->space_before);
    }
    for (std::size_t i = 0; i < stop.size(); i++) {
      const auto &[to, space] = stop[(i + 1) % stop.size()];
      if (!space) continue;
      if (to == kNone || stop[i].first == kNone)
        refuse("cells meet at a corner of the box", place_of(corner_of(side, 0)));
      edges.emplace_back(stop[i].first, to);
    }
  }

  void cover(int side) {
    std::vector<Edge> edges = rim_[side];
    add_border(side, edges);
    std::map<std::uint32_t, std::uint32_t> row;
    std::vector<std::uint32_t> vertex;
    std::vector<PlanePoint> point;
    const auto row_of = [&](std::uint32_t v) {
      const auto [at, fresh] = row.try_emplace(v, static_cast<std::uint32_t>(vertex.size()));
      if (fresh) {
        vertex.push_back(v);
        point.push_back({fixed(surface_.vertex[v][u_axis(side)]), fixed(surface_.vertex[v][v_axis(side)])});
      }
      return at->second;
    };
    for (Edge &edge : edges)
      edge = {row_of(edge.first), row_of(edge.second)};
    const bool up = side % 2;
    const std::int64_t bad =
        triangulate_region(point, edges, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
          surface_.face.emplace_back(vertex[a], vertex[up ? b : c], vertex[up ? c : b]);
        });
    if (bad >= 0)
      refuse("rims of cuts touch, or a cell's surface is open,",
             surface_.vertex[vertex[static_cast<std::size_t>(bad)]]);
  }

  // Every edge that touches a side has two faces that run along it in opposite directions.
  void check_closed() const {
    std::vector<std::uint8_t> on_side(surface_.vertex.size());
    for (std::uint32_t v = 0; v < on_side.size(); v++)
      for (int side = 0; side < 6; side++)
        on_side[v] |= lies_in(v, side);
    std::vector<Edge> edges;
    for (const glm::uvec3 &f : surface_.face)
      for (int k = 0; k < 3; k++)
        if (on_side[f[k]] && on_side[f[(k + 1) % 3]]) edges.emplace_back(f[k], f[(k + 1) % 3]);
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); i++)
      if ((i && edges[i] == edges[i - 1]) ||
          !std::binary_search(edges.begin(), edges.end(), Edge(edges[i].second, edges[i].first)))
        refuse("the surface does not close", surface_.vertex[edges[i].first]);
  }

  const conceg_box &box_;
  Surface &surface_;
  std::vector<Edge> rim_[6];
  std::map<std::uint32_t, int> balance_[6];
  std::vector<Crossing> crossing_[6];
  std::array<std::uint32_t, 8> corner_;
  std::array<int, 8> state_; // 1 space, 0 in a cell, -1 not known yet
};

} // namespace

void ExtracellularSurface::add(const Surface &closed, const std::vector<std::uint8_t> &label) {
  CutSurface cut = cut_at_box(box_, closed, true);
  for (glm::uvec3 &f : cut.face)
    std::swap(f.y, f.z);
  append(surface_, cut);
  for (const std::uint32_t face : cut.source_face)
    label_.push_back(label.empty() ? std::uint8_t(1) : label[face]);
}

void ExtracellularSurface::close() {
  Sides(box_, surface_).run();
  label_.resize(surface_.face.size(), 0);
}

} // namespace conceg::exporting
