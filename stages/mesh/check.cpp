// SPDX-License-Identifier: BSD-3-Clause
#include "check.hpp"
#include "distance.hpp"
#include "predicates.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <tuple>

namespace conceg::mesh {
namespace {

// ---- Topology: one surface by itself ----

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

// ---- Pairs: a uniform hash on the torus ----

struct Bounds {
  glm::dvec3 low, high;
};

struct HashEntry {
  std::uint64_t place; // hash cell in the base box
  std::uint32_t surface, face;
  std::int16_t lift[3]; // subtract lift * side to bring the face into the base box
};

bool operator<(const HashEntry &l, const HashEntry &r) {
  return std::tie(l.place, l.surface, l.face, l.lift[2], l.lift[1], l.lift[0]) <
         std::tie(r.place, r.surface, r.face, r.lift[2], r.lift[1], r.lift[0]);
}

class PairCheck {
public:
  PairCheck(const std::vector<Surface> &surfaces, const std::vector<std::uint8_t> &usable,
            const conceg_box &box, const CheckOptions &options, Workers &workers, const Progress &progress)
      : surfaces_(surfaces), usable_(usable), box_(box), options_(options), workers_(workers),
        progress_(progress) {
    margin_ = options.gap;
  }

  void run(CheckResult &result) {
    choose_places();
    hash_faces();
    find_runs();
    std::vector<Worker> workers(workers_.threads());
    for (Worker &worker : workers)
      worker.least2.assign(surfaces_.size(), 4 * options_.gap * options_.gap);
    std::atomic<std::uint64_t> done{0};
    workers_.loop(run_.size() - 1, 256, [&](std::size_t i, unsigned worker) {
      check_place(run_[i], run_[i + 1], workers[worker]);
      const std::uint64_t count = ++done;
      if (count % 16384 == 0) report(progress_, "mesh: check", count, run_.size());
    });
    result.min_gap.assign(surfaces_.size(), 2 * options_.gap);
    for (const Worker &worker : workers) {
      result.pairs_checked += worker.pairs;
      result.defects.insert(result.defects.end(), worker.found.begin(), worker.found.end());
      for (std::size_t s = 0; s < surfaces_.size(); s++)
        result.min_gap[s] = std::min(result.min_gap[s], std::sqrt(worker.least2[s]));
    }
  }

private:
  struct Item {
    glm::dvec3 low, high; // in the base box, with the margin
    glm::ivec3 first;     // lowest hash cell
    std::uint32_t surface, face;
    glm::ivec3 lift;
  };
  struct Worker {
    std::vector<Item> item;
    std::vector<Defect> found;
    std::vector<double> least2; // per surface: smallest squared gap so far
    std::uint64_t pairs = 0;
  };

  void corners(std::uint32_t surface, std::uint32_t face, glm::dvec3 (&out)[3]) const {
    const Surface &s = surfaces_[surface];
    const glm::uvec3 &f = s.face[face];
    out[0] = s.at(f.x), out[1] = s.at(f.y), out[2] = s.at(f.z);
  }

  Bounds bounds(std::uint32_t surface, std::uint32_t face) const {
    glm::dvec3 p[3];
    corners(surface, face, p);
    return {glm::min(glm::min(p[0], p[1]), p[2]) - margin_, glm::max(glm::max(p[0], p[1]), p[2]) + margin_};
  }

  // Hash cells about as large as a face, that divide periodic sides.
  void choose_places() {
    double sum = 0;
    std::uint64_t faces = 0;
    low_ = glm::dvec3(box_.lo[0], box_.lo[1], box_.lo[2]);
    glm::dvec3 high(box_.hi[0], box_.hi[1], box_.hi[2]);
    for (std::uint32_t s = 0; s < surfaces_.size(); s++) {
      if (!usable_[s]) continue;
      for (std::uint32_t f = 0; f < surfaces_[s].face.size(); f++) {
        const Bounds b = bounds(s, f);
        const glm::dvec3 size = b.high - b.low;
        sum += std::max({size.x, size.y, size.z});
        for (int axis = 0; axis < 3; axis++)
          if (!box_.periodic[axis])
            low_[axis] = std::min(low_[axis], b.low[axis]), high[axis] = std::max(high[axis], b.high[axis]);
      }
      faces += surfaces_[s].face.size();
    }
    const double wanted = faces ? std::max(1.5 * sum / double(faces), 1e-3) : 1.0;
    for (int axis = 0; axis < 3; axis++) {
      const double side = high[axis] - low_[axis];
      places_[axis] = static_cast<int>(std::min(double(1 << 20), std::max(1.0, std::floor(side / wanted))));
      inverse_[axis] = places_[axis] / side;
      side_[axis] = side;
    }
  }

  glm::ivec3 place_of(const glm::dvec3 &p) const {
    glm::ivec3 place;
    for (int axis = 0; axis < 3; axis++) {
      place[axis] = static_cast<int>(std::floor((p[axis] - low_[axis]) * inverse_[axis]));
      if (!box_.periodic[axis]) place[axis] = std::min(places_[axis] - 1, std::max(0, place[axis]));
    }
    return place;
  }

  void hash_faces() {
    std::vector<std::vector<HashEntry>> parts(surfaces_.size());
    workers_.loop(surfaces_.size(), 1, [&](std::size_t s, unsigned) {
      if (!usable_[s]) return;
      for (std::uint32_t f = 0; f < surfaces_[s].face.size(); f++)
        hash_face(static_cast<std::uint32_t>(s), f, parts[s]);
    });
    // Sorted layer by layer (z is the slowest axis of a place), so that layers are independent tasks.
    const auto layer_size = static_cast<std::uint64_t>(places_.x) * static_cast<std::uint64_t>(places_.y);
    std::vector<std::size_t> start(static_cast<std::size_t>(places_.z) + 1);
    for (const auto &part : parts)
      for (const HashEntry &entry : part)
        start[entry.place / layer_size + 1]++;
    std::partial_sum(start.begin(), start.end(), start.begin());
    entry_.resize(start.back());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (auto &part : parts) {
      for (const HashEntry &entry : part)
        entry_[next[entry.place / layer_size]++] = entry;
      part = {};
    }
    workers_.loop(static_cast<std::size_t>(places_.z), 1, [&](std::size_t layer, unsigned) {
      std::sort(entry_.begin() + static_cast<std::ptrdiff_t>(start[layer]),
                entry_.begin() + static_cast<std::ptrdiff_t>(start[layer + 1]));
    });
  }

  void hash_face(std::uint32_t surface, std::uint32_t face, std::vector<HashEntry> &out) const {
    const Bounds b = bounds(surface, face);
    const glm::ivec3 first = place_of(b.low), last = place_of(b.high);
    for (int z = first.z; z <= last.z; z++)
      for (int y = first.y; y <= last.y; y++)
        for (int x = first.x; x <= last.x; x++) {
          const int at[3] = {x, y, z};
          HashEntry entry = {0, surface, face, {0, 0, 0}};
          for (int axis = 2; axis >= 0; axis--) {
            const int lift =
                at[axis] >= 0 ? at[axis] / places_[axis] : -((places_[axis] - 1 - at[axis]) / places_[axis]);
            entry.lift[axis] = static_cast<std::int16_t>(lift);
            entry.place = entry.place * static_cast<std::uint64_t>(places_[axis]) +
                          static_cast<std::uint64_t>(at[axis] - lift * places_[axis]);
          }
          out.push_back(entry);
        }
  }

  void find_runs() {
    for (std::size_t i = 0; i < entry_.size(); i++)
      if (i == 0 || entry_[i].place != entry_[i - 1].place) run_.push_back(i);
    run_.push_back(entry_.size());
  }

  void check_place(std::size_t first, std::size_t last, Worker &worker) const {
    worker.item.clear();
    for (std::size_t i = first; i < last; i++) {
      const HashEntry &e = entry_[i];
      const Bounds b = bounds(e.surface, e.face);
      const glm::ivec3 lift(e.lift[0], e.lift[1], e.lift[2]);
      const glm::dvec3 shift = glm::dvec3(lift) * side_;
      worker.item.push_back(
          {b.low - shift, b.high - shift, place_of(b.low) - lift * places_, e.surface, e.face, lift});
    }
    const std::uint64_t place = entry_[first].place;
    const auto nx = static_cast<std::uint64_t>(places_.x), ny = static_cast<std::uint64_t>(places_.y);
    const glm::ivec3 here(static_cast<int>(place % nx), static_cast<int>(place / nx % ny),
                          static_cast<int>(place / (nx * ny)));
    for (std::size_t i = 0; i < worker.item.size(); i++)
      for (std::size_t j = i + 1; j < worker.item.size(); j++) {
        const Item &a = worker.item[i], &b = worker.item[j];
        if (a.low.x > b.high.x || b.low.x > a.high.x || a.low.y > b.high.y || b.low.y > a.high.y ||
            a.low.z > b.high.z || b.low.z > a.high.z)
          continue;
        // Each pair once: in the hash cell of the lower corner of what the two boxes share.
        if (glm::max(a.first, b.first) != here) continue;
        check_pair(a, b, worker);
      }
  }

  void check_pair(const Item &a, const Item &b, Worker &worker) const {
    glm::dvec3 p[3], q[3];
    corners(a.surface, a.face, p);
    corners(b.surface, b.face, q);
    const glm::ivec3 lift = a.lift - b.lift;
    if (lift != glm::ivec3(0))
      for (glm::dvec3 &corner : q)
        corner += glm::dvec3(lift) * side_;
    const bool same = a.surface == b.surface && lift == glm::ivec3(0);
    if (!touching_boxes(a, b)) { // within the margin only
      if (!same) measure(a, b, p, q, worker);
      return;
    }
    worker.pairs++;
    if (same) {
      check_neighbours(a, b, p, q, worker);
    } else if (triangles_meet(p, q)) {
      worker.least2[a.surface] = worker.least2[b.surface] = 0;
      add(a.surface == b.surface ? Flaw::crossing_image : Flaw::crossing_cells, a, b, p, worker);
    } else {
      measure(a, b, p, q, worker);
    }
  }

  bool touching_boxes(const Item &a, const Item &b) const {
    for (int axis = 0; axis < 3; axis++)
      if (a.low[axis] > b.high[axis] - 2 * margin_ + 1e-9 || b.low[axis] > a.high[axis] - 2 * margin_ + 1e-9)
        return false;
    return true;
  }

  // Faces of one surface: common vertices (by number) come first, then what else they share is asked.
  void check_neighbours(const Item &a, const Item &b, glm::dvec3 (&p)[3], glm::dvec3 (&q)[3],
                        Worker &worker) const {
    const glm::uvec3 &f = surfaces_[a.surface].face[a.face], &g = surfaces_[b.surface].face[b.face];
    int common = 0;
    std::array<std::uint32_t, 3> left = {f.x, f.y, f.z}, right = {g.x, g.y, g.z};
    for (int i = 0; i < 3; i++)
      for (int j = common; j < 3; j++)
        if (i >= common && left[i] == right[j]) {
          std::swap(left[common], left[i]), std::swap(p[common], p[i]);
          std::swap(right[common], right[j]), std::swap(q[common], q[j]);
          common++;
          break;
        }
    if (common == 0   ? triangles_meet(p, q)
        : common == 1 ? meet_beyond_vertex(p, q)
        : common == 2 ? meet_beyond_edge(p, q)
                      : true)
      add(common ? Flaw::fold : Flaw::crossing_self, a, b, p, worker);
  }

  void measure(const Item &a, const Item &b, const glm::dvec3 (&p)[3], const glm::dvec3 (&q)[3],
               Worker &worker) const {
    if (!(options_.gap > 0)) return;
    double &left = worker.least2[a.surface], &right = worker.least2[b.surface];
    const double least2 = options_.least_gap * options_.least_gap, bound = std::max({left, right, least2});
    double apart2 = 0;
    for (int axis = 0; axis < 3; axis++) {
      const double apart =
          std::max(0.0, std::max(a.low[axis] - b.high[axis], b.low[axis] - a.high[axis]) + 2 * margin_);
      apart2 += apart * apart;
    }
    if (apart2 >= bound || beside_plane(p, q, bound) || beside_plane(q, p, bound)) return;
    const double distance2 = triangle_distance2(p, q);
    left = std::min(left, distance2), right = std::min(right, distance2);
    if (distance2 < least2) add(Flaw::near, a, b, p, worker);
  }

  // All of q lies on one side of the plane of p, no nearer than sqrt(bound2).
  static bool beside_plane(const glm::dvec3 (&p)[3], const glm::dvec3 (&q)[3], double bound2) {
    const glm::dvec3 normal = cross_product(p[1] - p[0], p[2] - p[0]);
    const double d0 = glm::dot(normal, q[0] - p[0]), d1 = glm::dot(normal, q[1] - p[0]),
                 d2 = glm::dot(normal, q[2] - p[0]);
    const double low = std::min({d0, d1, d2}), high = std::max({d0, d1, d2});
    const double nearest = low > 0 ? low : high < 0 ? -high : 0;
    return nearest * nearest >= bound2 * glm::dot(normal, normal) * (1 + 1e-9);
  }

  void add(Flaw flaw, const Item &a, const Item &b, const glm::dvec3 (&p)[3], Worker &worker) const {
    worker.found.push_back(
        {flaw, a.surface, a.face, b.surface, b.face, a.lift - b.lift, (p[0] + p[1] + p[2]) / 3.0});
  }

  const std::vector<Surface> &surfaces_;
  const std::vector<std::uint8_t> &usable_;
  const conceg_box &box_;
  const CheckOptions &options_;
  Workers &workers_;
  const Progress &progress_;
  double margin_ = 0;
  glm::dvec3 low_{}, inverse_{}, side_{};
  glm::ivec3 places_{1};
  std::vector<HashEntry> entry_;
  std::vector<std::size_t> run_;
};

bool earlier(const Defect &l, const Defect &r) {
  return std::tie(l.flaw, l.surface, l.face, l.other_surface, l.other_face, l.lift.z, l.lift.y, l.lift.x) <
         std::tie(r.flaw, r.surface, r.face, r.other_surface, r.other_face, r.lift.z, r.lift.y, r.lift.x);
}

} // namespace

const char *flaw_name(Flaw flaw) {
  static const char *const names[] = {"face with a bad vertex index",
                                      "degenerate face",
                                      "unused vertex",
                                      "open edge",
                                      "face turned against its neighbour",
                                      "vertex with several fans",
                                      "surface facing inwards",
                                      "two cells cross",
                                      "cell crosses its own image",
                                      "cell crosses itself",
                                      "fold",
                                      "narrow gap"};
  return names[static_cast<std::size_t>(flaw)];
}

CheckResult check_surfaces(const std::vector<Surface> &surfaces, const conceg_box &box,
                           const CheckOptions &options, Workers &workers, const Progress &progress) {
  CheckResult result;
  std::vector<std::vector<Defect>> found(surfaces.size());
  std::vector<std::uint8_t> usable(surfaces.size());
  workers.loop(surfaces.size(), 1, [&](std::size_t s, unsigned) {
    usable[s] = Topology(surfaces[s], static_cast<std::uint32_t>(s), found[s]).run();
  });
  for (std::size_t s = 0; s < surfaces.size(); s++) {
    result.closed.push_back(found[s].empty());
    result.defects.insert(result.defects.end(), found[s].begin(), found[s].end());
  }
  PairCheck(surfaces, usable, box, options, workers, progress).run(result);
  std::sort(result.defects.begin(), result.defects.end(), earlier);
  for (const Defect &defect : result.defects) {
    result.errors += defect.flaw != Flaw::near;
    result.crossings += is_pair(defect.flaw) && defect.flaw != Flaw::near;
  }
  return result;
}

std::string describe(const Defect &defect, const std::vector<Surface> &surfaces) {
  char text[320];
  const unsigned cell = surfaces[defect.surface].cell;
  if (!is_pair(defect.flaw)) {
    const bool vertex = defect.flaw == Flaw::unused_vertex || defect.flaw == Flaw::split_vertex;
    std::snprintf(text, sizeof text, "%s: cell %u, %s %u, at (%.4f, %.4f, %.4f) um", flaw_name(defect.flaw),
                  cell, vertex ? "vertex" : "face", defect.face, defect.where.x, defect.where.y,
                  defect.where.z);
  } else {
    std::snprintf(text, sizeof text,
                  "%s: cell %u, face %u and cell %u, face %u (image %d %d %d), at (%.4f, %.4f, %.4f) um",
                  flaw_name(defect.flaw), cell, defect.face, surfaces[defect.other_surface].cell,
                  defect.other_face, defect.lift.x, defect.lift.y, defect.lift.z, defect.where.x,
                  defect.where.y, defect.where.z);
  }
  return text;
}

} // namespace conceg::mesh
