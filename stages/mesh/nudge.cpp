// SPDX-License-Identifier: BSD-3-Clause
#include "nudge.hpp"
#include "distance.hpp"
#include "predicates.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::mesh {
namespace {

constexpr int kSweeps = 12;
constexpr double kMore = 1.05;      // pairs are moved apart by a little more than they have to be
constexpr double kLeastTurn = 0.25; // cosine between a face's normals before and after
constexpr double kLeastArea = 0.1;  // of a face's area before

class Nudge {
public:
  Nudge(const Views &surfaces, const std::vector<std::uint8_t> &fixed, const conceg_box &box,
        const NudgeOptions &options)
      : surfaces_(surfaces), fixed_(fixed), options_(options) {
    for (int axis = 0; axis < 3; axis++)
      side_[axis] = conceg_box_side(&box, axis);
  }

  Nudged run(const std::vector<Defect> &defects, Workers &workers) {
    list_vertices(defects);
    unfold(workers);
    for (int sweep = 0; sweep < kSweeps; sweep++) {
      bool any = false;
      for (Pair &pair : pair_)
        any |= settle(pair);
      if (!any) break;
    }
    return collect(workers);
  }

private:
  struct Vertex {
    std::uint32_t surface, number;
    glm::dvec3 at, before;
    std::uint32_t moves = 0;
    bool folded = false; // its surface folds or crosses itself here
  };
  struct Pair {
    std::uint32_t corner[6];          // of the one face, then of the other: into vertex_
    glm::dvec3 shift;                 // of the other one
    bool loose[2];                    // may this one move?
    std::uint32_t seen = 0xffffffffu; // moves of its vertices when it was well
  };

  void list_vertices(const std::vector<Defect> &defects) {
    std::vector<const Defect *> wanted;
    for (const Defect &d : defects)
      if (is_pair(d.flaw) && !(fixed_[d.surface] && fixed_[d.other_surface])) wanted.push_back(&d);
    std::vector<std::uint64_t> key;
    const auto corners = [&](const Defect &d, std::uint64_t(&out)[6]) {
      const glm::uvec3 &f = surfaces_[d.surface].face[d.face],
                       &g = surfaces_[d.other_surface].face[d.other_face];
      for (int k = 0; k < 3; k++)
        out[k] = std::uint64_t(d.surface) << 32 | f[k],
        out[k + 3] = std::uint64_t(d.other_surface) << 32 | g[k];
    };
    std::uint64_t corner[6];
    for (const Defect *d : wanted)
      corners(*d, corner), key.insert(key.end(), corner, corner + 6);
    std::sort(key.begin(), key.end());
    key.erase(std::unique(key.begin(), key.end()), key.end());
    for (const std::uint64_t k : key) {
      const auto surface = static_cast<std::uint32_t>(k >> 32), number = static_cast<std::uint32_t>(k);
      const glm::dvec3 at = surfaces_[surface].at(number);
      vertex_.push_back({surface, number, at, at});
    }
    for (const Defect *d : wanted) {
      Pair pair;
      corners(*d, corner);
      for (int k = 0; k < 6; k++)
        pair.corner[k] =
            static_cast<std::uint32_t>(std::lower_bound(key.begin(), key.end(), corner[k]) - key.begin());
      if (d->flaw == Flaw::fold || d->flaw == Flaw::crossing_self) {
        for (const std::uint32_t k : pair.corner)
          vertex_[k].folded = true;
        continue;
      }
      pair.shift = glm::dvec3(d->lift) * side_;
      pair.loose[0] = !fixed_[d->surface], pair.loose[1] = !fixed_[d->other_surface];
      pair_.push_back(pair);
    }
  }

  // Vertices where a surface folds go half the way to the mean of their neighbours.
  void unfold(Workers &workers) {
    std::vector<std::size_t> first; // of the vertices of each surface with folds
    for (std::size_t i = 0; i < vertex_.size(); i++)
      if (vertex_[i].folded && (first.empty() || vertex_[first.back()].surface != vertex_[i].surface))
        first.push_back(i);
    workers.loop(first.size(), 1, [&](std::size_t i, unsigned) { unfold_surface(first[i]); });
  }

  void unfold_surface(std::size_t first) {
    const SurfaceView &surface = surfaces_[vertex_[first].surface];
    std::vector<Vertex *> of(surface.vertices);
    std::size_t last = first;
    for (; last < vertex_.size() && vertex_[last].surface == vertex_[first].surface; last++)
      if (vertex_[last].folded) of[vertex_[last].number] = &vertex_[last];
    std::vector<glm::dvec3> sum(last - first);
    std::vector<double> count(last - first);
    for (std::uint32_t f = 0; f < surface.faces; f++)
      for (int k = 0; k < 3; k++) {
        const glm::uvec3 &v = surface.face[f];
        if (!of[v[k]]) continue;
        const auto i = static_cast<std::size_t>(of[v[k]] - &vertex_[first]);
        sum[i] += surface.at(v[(k + 1) % 3]), count[i]++; // each neighbour follows once
      }
    for (std::size_t i = 0; i < sum.size(); i++)
      if (vertex_[first + i].folded && count[i] > 0) {
        Vertex &v = vertex_[first + i];
        place(v, v.at + 0.5 * (sum[i] / count[i] - v.at));
      }
  }

  // Moves the two faces of a pair apart; false when they are already.
  bool settle(Pair &pair) {
    std::uint32_t moves = 0;
    for (const std::uint32_t corner : pair.corner)
      moves += vertex_[corner].moves;
    if (moves == pair.seen) return false;
    Corners p, q;
    for (int k = 0; k < 3; k++)
      p[k] = vertex_[pair.corner[k]].at, q[k] = vertex_[pair.corner[k + 3]].at + pair.shift;
    const double wanted = kMore * options_.least_gap;
    if (triangles_meet(p, q)) {
      const double each = wanted / (pair.loose[0] + pair.loose[1]);
      if (pair.loose[0]) move(pair.corner, {1, 1, 1}, -each * normal_of(p));
      if (pair.loose[1]) move(pair.corner + 3, {1, 1, 1}, -each * normal_of(q));
      return true;
    }
    const NearestPoints nearest = nearest_points(p, q);
    const glm::dvec3 apart = nearest.on_a - nearest.on_b;
    const double distance = glm::length(apart);
    if (distance >= wanted || !(distance > 0)) {
      pair.seen = moves;
      return false;
    }
    const glm::dvec3 step = apart * ((wanted - distance) / distance / (pair.loose[0] + pair.loose[1]));
    if (pair.loose[0]) move(pair.corner, weights(p, nearest.on_a), step);
    if (pair.loose[1]) move(pair.corner + 3, weights(q, nearest.on_b), -step);
    return true;
  }

  static glm::dvec3 normal_of(const Corners &p) {
    const glm::dvec3 normal = cross_product(p[1] - p[0], p[2] - p[0]);
    return normal / std::max(glm::length(normal), 1e-300);
  }

  // How far each corner has to go, over the way of a point of the face, so that the point gets there.
  static glm::dvec3 weights(const Corners &t, const glm::dvec3 &p) {
    const glm::dvec3 normal = cross_product(t[1] - t[0], t[2] - t[0]);
    const double all = glm::dot(normal, normal);
    if (!(all > 0)) return glm::dvec3(1);
    glm::dvec3 share;
    for (int k = 0; k < 3; k++)
      share[k] = glm::dot(normal, cross_product(t[(k + 1) % 3] - p, t[(k + 2) % 3] - p)) / all;
    return share / glm::dot(share, share);
  }

  void move(const std::uint32_t *corner, const glm::dvec3 &weight, const glm::dvec3 &step) {
    for (int k = 0; k < 3; k++) {
      Vertex &v = vertex_[corner[k]];
      place(v, v.at + weight[k] * step);
    }
  }

  void place(Vertex &v, const glm::dvec3 &to) const {
    const double way = glm::length(to - v.before);
    v.at = way <= options_.farthest ? to : v.before + (to - v.before) * (options_.farthest / way);
    v.moves++;
  }

  // What has moved, as it is written, surface by surface.
  Nudged collect(Workers &workers) {
    Nudged out;
    out.vertex.resize(surfaces_.size()), out.changed.face.resize(surfaces_.size());
    out.changed.surface.resize(surfaces_.size());
    std::vector<std::vector<std::uint32_t>> folded(surfaces_.size());
    for (const Vertex &v : vertex_) {
      const SurfaceView &surface = surfaces_[v.surface];
      const glm::vec3 at = written(v.at - surface.origin);
      if (v.moves && at != surface.relative[v.number]) out.vertex[v.surface].push_back({v.number, at});
      if (v.folded) folded[v.surface].push_back(v.number);
    }
    workers.loop(surfaces_.size(), 1, [&](std::size_t s, unsigned) {
      if (!out.vertex[s].empty()) keep_faces_up(surfaces_[s], folded[s], out.vertex[s], out.changed.face[s]);
    });
    for (const auto &moved : out.vertex)
      out.count += moved.size();
    return out;
  }

  // Vertices of faces that would turn over go back, until no face does; where a surface is `folded` faces
  // may, as long as they keep an area. `faces`: those that have changed.
  static void keep_faces_up(const SurfaceView &surface, const std::vector<std::uint32_t> &folded,
                            std::vector<MovedVertex> &moved, Bits &faces) {
    const auto is_folded = [&](std::uint32_t v) {
      return std::binary_search(folded.begin(), folded.end(), v);
    };
    Bits is_moved;
    is_moved.reset(surface.vertices);
    for (const MovedVertex &v : moved)
      is_moved.set(v.vertex);
    std::vector<std::uint32_t> touched;
    for (std::uint32_t f = 0; f < surface.faces; f++)
      if (is_moved[surface.face[f].x] || is_moved[surface.face[f].y] || is_moved[surface.face[f].z])
        touched.push_back(f);
    const auto place = [&](std::uint32_t v) {
      if (!is_moved[v]) return glm::dvec3(surface.relative[v]);
      const auto found = std::lower_bound(moved.begin(), moved.end(), v,
                                          [](const MovedVertex &m, std::uint32_t n) { return m.vertex < n; });
      return glm::dvec3(found->place);
    };
    for (bool again = true; again;) {
      again = false;
      for (const std::uint32_t f : touched) {
        const glm::uvec3 &v = surface.face[f];
        if (!(is_moved[v.x] || is_moved[v.y] || is_moved[v.z])) continue;
        const glm::dvec3 a(surface.relative[v.x]), b(surface.relative[v.y]), c(surface.relative[v.z]);
        const glm::dvec3 before = cross_product(b - a, c - a),
                         after = cross_product(place(v.y) - place(v.x), place(v.z) - place(v.x));
        const double old_area = glm::length(before), new_area = glm::length(after);
        const bool may_turn = is_folded(v.x) || is_folded(v.y) || is_folded(v.z);
        if ((may_turn || glm::dot(before, after) > kLeastTurn * old_area * new_area) &&
            new_area > kLeastArea * old_area)
          continue;
        is_moved.clear(v.x), is_moved.clear(v.y), is_moved.clear(v.z);
        again = true;
      }
    }
    moved.erase(
        std::remove_if(moved.begin(), moved.end(), [&](const MovedVertex &v) { return !is_moved[v.vertex]; }),
        moved.end());
    faces.reset(surface.faces);
    for (const std::uint32_t f : touched) {
      const glm::uvec3 &v = surface.face[f];
      if (is_moved[v.x] || is_moved[v.y] || is_moved[v.z]) faces.set(f);
    }
  }

  const Views &surfaces_;
  const std::vector<std::uint8_t> &fixed_;
  const NudgeOptions &options_;
  glm::dvec3 side_{};
  std::vector<Vertex> vertex_; // by surface and number
  std::vector<Pair> pair_;
};

} // namespace

Nudged nudge(const Views &surfaces, const std::vector<Defect> &defects,
             const std::vector<std::uint8_t> &fixed, const conceg_box &box, const NudgeOptions &options,
             Workers &workers) {
  return Nudge(surfaces, fixed, box, options).run(defects, workers);
}

} // namespace conceg::mesh
