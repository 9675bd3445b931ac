// SPDX-License-Identifier: BSD-3-Clause
#include "pairs.hpp"
#include "distance.hpp"
#include "predicates.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace conceg::mesh {
namespace {

constexpr double kPlace = 1.1;             // edge of a hash cell over the mean size of a face with its margin
constexpr std::size_t kSlab = 12u << 20;   // entries of the hash that are held at a time
constexpr std::size_t kStretch = 1u << 15; // faces of one task

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

std::uint64_t pair_key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

class PairCheck {
public:
  PairCheck(const std::vector<Surface> &surfaces, const std::vector<std::uint8_t> &usable,
            const std::vector<std::uint8_t> &changed, const conceg_box &box, const CheckOptions &options,
            Workers &workers, const Progress &progress)
      : surfaces_(surfaces), usable_(usable), changed_(changed), box_(box), options_(options),
        workers_(workers), progress_(progress), margin_(0.5 * kGapReach * options.gap),
        far2_(4 * margin_ * margin_) {}

  void run(CheckResult &result) {
    list_stretches();
    choose_places();
    worker_.resize(workers_.threads());
    for (int first = 0; first < places_.z;) {
      const int last = end_of_slab(first);
      hash_slab(first, last);
      mark_changed();
      workers_.loop(run_.empty() ? 0 : run_.size() - 1, 256, [&](std::size_t i, unsigned worker) {
        if (worth_[i]) check_place(run_[i], run_[i + 1], worker_[worker]);
      });
      report(progress_, "mesh: check", static_cast<std::uint64_t>(last),
             static_cast<std::uint64_t>(places_.z));
      first = last;
    }
    for (const Worker &worker : worker_) {
      result.pairs_checked += worker.pairs;
      result.defects.insert(result.defects.end(), worker.found.begin(), worker.found.end());
      for (const auto &[key, gap2] : worker.gap2)
        result.gaps.push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key), gap2});
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
    std::array<std::vector<float>, 6>
        side; // low and high of the items, around the hash cell, rounded outwards
    std::vector<std::uint8_t> meets;
    std::vector<Defect> found;
    std::unordered_map<std::uint64_t, double> gap2; // per pair of surfaces: smallest squared gap so far
    std::uint64_t pairs = 0, last_key = ~std::uint64_t(0);
    double *last = nullptr; // references into the map stay good
    double &gap(std::uint32_t a, std::uint32_t b, double far2) {
      const std::uint64_t key = pair_key(a, b);
      if (key != last_key) last = &gap2.emplace(key, far2).first->second, last_key = key;
      return *last;
    }
  };
  struct Stretch {
    std::uint32_t surface, first, last; // faces
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

  void list_stretches() {
    for (std::uint32_t s = 0; s < surfaces_.size(); s++)
      for (std::size_t f = 0; usable_[s] && f < surfaces_[s].face.size(); f += kStretch)
        stretch_.push_back({s, static_cast<std::uint32_t>(f),
                            static_cast<std::uint32_t>(std::min(f + kStretch, surfaces_[s].face.size()))});
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
    const double wanted = faces ? std::max(kPlace * sum / double(faces), 1e-3) : 1.0;
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

  // Layers [first, end) whose entries fit into one slab; counts the entries of all layers the first time.
  int end_of_slab(int first) {
    if (layer_.empty()) count_layers();
    std::size_t sum = layer_[static_cast<std::size_t>(first)];
    int end = first + 1;
    while (end < places_.z && sum + layer_[static_cast<std::size_t>(end)] <= kSlab)
      sum += layer_[static_cast<std::size_t>(end++)];
    return end;
  }

  void count_layers() {
    std::vector<std::vector<std::uint32_t>> counts(workers_.threads());
    for (auto &count : counts)
      count.resize(static_cast<std::size_t>(places_.z));
    workers_.loop(stretch_.size(), 1, [&](std::size_t i, unsigned worker) {
      for (std::uint32_t f = stretch_[i].first; f < stretch_[i].last; f++) {
        const Bounds b = bounds(stretch_[i].surface, f);
        const glm::ivec3 from = place_of(b.low), to = place_of(b.high);
        const auto layer = static_cast<std::uint32_t>((to.x - from.x + 1) * (to.y - from.y + 1));
        for (int z = from.z; z <= to.z; z++)
          counts[worker][static_cast<std::size_t>(z - lift_of(z, 2) * places_.z)] += layer;
      }
    });
    layer_.resize(static_cast<std::size_t>(places_.z));
    for (const auto &count : counts)
      for (std::size_t z = 0; z < layer_.size(); z++)
        layer_[z] += count[z];
  }

  int lift_of(int place, int axis) const {
    return place >= 0 ? place / places_[axis] : -((places_[axis] - 1 - place) / places_[axis]);
  }

  // Entries of the layers [first, last), sorted; layers are independent tasks.
  void hash_slab(int first, int last) {
    std::vector<std::vector<HashEntry>> parts(stretch_.size());
    workers_.loop(stretch_.size(), 1, [&](std::size_t i, unsigned) {
      for (std::uint32_t f = stretch_[i].first; f < stretch_[i].last; f++)
        hash_face(stretch_[i].surface, f, first, last, parts[i]);
    });
    const auto layer_size = static_cast<std::uint64_t>(places_.x) * static_cast<std::uint64_t>(places_.y);
    const auto layer_of = [&](const HashEntry &e) {
      return e.place / layer_size - static_cast<std::uint64_t>(first);
    };
    const auto layers = static_cast<std::size_t>(last - first);
    std::vector<std::size_t> start(layers + 1);
    for (int z = first; z < last; z++)
      start[static_cast<std::size_t>(z - first) + 1] =
          start[static_cast<std::size_t>(z - first)] + layer_[static_cast<std::size_t>(z)];
    entry_.resize(start.back());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (auto &part : parts) {
      for (const HashEntry &entry : part)
        entry_[next[layer_of(entry)]++] = entry;
      part = {};
    }
    workers_.loop(layers, 1, [&](std::size_t layer, unsigned) {
      std::sort(entry_.begin() + static_cast<std::ptrdiff_t>(start[layer]),
                entry_.begin() + static_cast<std::ptrdiff_t>(start[layer + 1]));
    });
    run_.clear();
    for (std::size_t i = 0; i < entry_.size(); i++)
      if (i == 0 || entry_[i].place != entry_[i - 1].place) run_.push_back(i);
    run_.push_back(entry_.size());
  }

  void hash_face(std::uint32_t surface, std::uint32_t face, int first_layer, int last_layer,
                 std::vector<HashEntry> &out) const {
    const Bounds b = bounds(surface, face);
    const glm::ivec3 first = place_of(b.low), last = place_of(b.high);
    for (int z = first.z; z <= last.z; z++) {
      const int layer = z - lift_of(z, 2) * places_.z;
      if (layer < first_layer || layer >= last_layer) continue;
      for (int y = first.y; y <= last.y; y++)
        for (int x = first.x; x <= last.x; x++) {
          const int at[3] = {x, y, z};
          HashEntry entry = {0, surface, face, {0, 0, 0}};
          for (int axis = 2; axis >= 0; axis--) {
            const int lift = lift_of(at[axis], axis);
            entry.lift[axis] = static_cast<std::int16_t>(lift);
            entry.place = entry.place * static_cast<std::uint64_t>(places_[axis]) +
                          static_cast<std::uint64_t>(at[axis] - lift * places_[axis]);
          }
          out.push_back(entry);
        }
    }
  }

  // Only places with a face that is new need a look.
  void mark_changed() {
    worth_.assign(run_.size(), 0);
    for (std::size_t i = 0; i + 1 < run_.size(); i++)
      for (std::size_t e = run_[i]; e < run_[i + 1] && !worth_[i]; e++)
        worth_[i] = changed_[entry_[e].surface];
  }

  void check_place(std::size_t first, std::size_t last, Worker &worker) const {
    const std::uint64_t place = entry_[first].place;
    const auto nx = static_cast<std::uint64_t>(places_.x), ny = static_cast<std::uint64_t>(places_.y);
    const glm::ivec3 here(static_cast<int>(place % nx), static_cast<int>(place / nx % ny),
                          static_cast<int>(place / (nx * ny)));
    fill_items(first, last, here, worker);
    const std::size_t count = worker.item.size();
    for (std::size_t i = 0; i + 1 < count; i++) {
      find_meeting(i, count, worker);
      for (std::size_t j = i + 1; j < count; j++) {
        if (!worker.meets[j]) continue;
        const Item &a = worker.item[i], &b = worker.item[j];
        if (!changed_[a.surface] && !changed_[b.surface]) continue;
        if (a.low.x > b.high.x || b.low.x > a.high.x || a.low.y > b.high.y || b.low.y > a.high.y ||
            a.low.z > b.high.z || b.low.z > a.high.z)
          continue;
        // Each pair once: in the hash cell of the lower corner of what the two boxes share.
        if (glm::max(a.first, b.first) != here) continue;
        check_pair(a, b, worker);
      }
    }
  }

  void fill_items(std::size_t first, std::size_t last, const glm::ivec3 &here, Worker &worker) const {
    worker.item.clear();
    for (auto &side : worker.side)
      side.resize(last - first);
    worker.meets.resize(last - first);
    const glm::dvec3 corner = low_ + glm::dvec3(here) / inverse_;
    for (std::size_t i = first; i < last; i++) {
      const HashEntry &e = entry_[i];
      const Bounds b = bounds(e.surface, e.face);
      const glm::ivec3 lift(e.lift[0], e.lift[1], e.lift[2]);
      const glm::dvec3 shift = glm::dvec3(lift) * side_;
      worker.item.push_back(
          {b.low - shift, b.high - shift, place_of(b.low) - lift * places_, e.surface, e.face, lift});
      const Item &item = worker.item.back();
      for (int axis = 0; axis < 3; axis++) {
        const double low = item.low[axis] - corner[axis], high = item.high[axis] - corner[axis];
        worker.side[static_cast<std::size_t>(axis)][i - first] =
            static_cast<float>(low - 1e-6 * (1 + std::fabs(low)));
        worker.side[static_cast<std::size_t>(axis + 3)][i - first] =
            static_cast<float>(high + 1e-6 * (1 + std::fabs(high)));
      }
    }
  }

  // Marks the items after i whose boxes may meet that of i.
  static void find_meeting(std::size_t i, std::size_t count, Worker &worker) {
    const float *lx = worker.side[0].data(), *ly = worker.side[1].data(), *lz = worker.side[2].data(),
                *hx = worker.side[3].data(), *hy = worker.side[4].data(), *hz = worker.side[5].data();
    const float ax = lx[i], ay = ly[i], az = lz[i], bx = hx[i], by = hy[i], bz = hz[i];
    std::uint8_t *meets = worker.meets.data();
    for (std::size_t j = i + 1; j < count; j++)
      meets[j] = static_cast<std::uint8_t>((lx[j] <= bx) & (ly[j] <= by) & (lz[j] <= bz) & (hx[j] >= ax) &
                                           (hy[j] >= ay) & (hz[j] >= az));
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
      worker.gap(a.surface, b.surface, far2_) = 0;
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
    double &gap2 = worker.gap(a.surface, b.surface, far2_);
    const double least2 = options_.least_gap * options_.least_gap, bound = std::max(gap2, least2);
    double apart2 = 0;
    for (int axis = 0; axis < 3; axis++) {
      const double apart =
          std::max(0.0, std::max(a.low[axis] - b.high[axis], b.low[axis] - a.high[axis]) + 2 * margin_);
      apart2 += apart * apart;
    }
    if (apart2 >= bound || beside_plane(p, q, bound) || beside_plane(q, p, bound)) return;
    const double distance2 = triangle_distance2(p, q);
    gap2 = std::min(gap2, distance2);
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
  const std::vector<std::uint8_t> &usable_, &changed_;
  const conceg_box &box_;
  const CheckOptions &options_;
  Workers &workers_;
  const Progress &progress_;
  double margin_, far2_;
  glm::dvec3 low_{}, inverse_{}, side_{};
  glm::ivec3 places_{1};
  std::vector<Stretch> stretch_;
  std::vector<std::size_t> layer_; // entries of each layer of places
  std::vector<HashEntry> entry_;   // of the slab
  std::vector<std::size_t> run_;   // where each place begins
  std::vector<std::uint8_t> worth_;
  std::vector<Worker> worker_;
};

} // namespace

void check_pairs(const std::vector<Surface> &surfaces, const std::vector<std::uint8_t> &usable,
                 const std::vector<std::uint8_t> &changed, const conceg_box &box, const CheckOptions &options,
                 Workers &workers, const Progress &progress, CheckResult &result) {
  PairCheck(surfaces, usable, changed, box, options, workers, progress).run(result);
}

} // namespace conceg::mesh
