// SPDX-License-Identifier: BSD-3-Clause
#include "pairs.hpp"
#include "distance.hpp"
#include "leaves.hpp"
#include "predicates.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <memory>

namespace conceg::mesh {
namespace {

constexpr double kPlace = 2.5;            // edge of a hash place over the mean size of a face
constexpr std::size_t kStretch = 1u << 8; // faces of one task, few so that they lie in few slabs
constexpr double kClearly = 1e-12;        // relative; a plane test is off by 1e-15

struct Stretch {
  std::uint32_t surface, first, last; // faces
  int low = 0, high = 0;              // layers of hash places, unwrapped
};

using Triangle = glm::dvec3[3];

class PairCheck {
public:
  PairCheck(const Views &surfaces, const Changed &changed, const conceg_box &box, const CheckOptions &options,
            Workers &workers, const Progress &progress, CheckResult &result)
      : surfaces_(surfaces), changed_(changed), box_(box), options_(options), workers_(workers),
        progress_(progress), result_(result), margin_(0.5 * options.reach),
        least2_(options.least_gap * options.least_gap),
        all_changed_(std::all_of(changed.surface.begin(), changed.surface.end(),
                                 [](std::uint8_t c) { return c != 0; })) {}

  void run() {
    choose_places();
    list_stretches();
    worker_.resize(workers_.threads());
    for (Worker &worker : worker_)
      worker.gap2.assign(surfaces_.size(), options_.reach * options_.reach);
    for (int first = 0; first < places_.z;) {
      slab_low_ = first, slab_high_ = end_of_slab(first);
      check_slab();
      if (options_.forget) options_.forget();
      report(progress_, "mesh: check", static_cast<std::uint64_t>(slab_high_),
             static_cast<std::uint64_t>(places_.z));
      first = slab_high_;
    }
    for (const Worker &worker : worker_) {
      result_.pairs_checked += worker.pairs;
      result_.defects.insert(result_.defects.end(), worker.found.begin(), worker.found.end());
      for (std::size_t s = 0; s < surfaces_.size(); s++)
        result_.min_gap[s] = std::min(result_.min_gap[s], std::sqrt(worker.gap2[s]));
    }
  }

private:
  struct Worker {
    Items item;
    std::vector<Defect> found;
    std::vector<double> gap2; // per surface: smallest squared gap so far
    std::uint64_t pairs = 0;
  };

  void corners(std::uint32_t surface, std::uint32_t face, Triangle &out) const {
    const SurfaceView &s = surfaces_[surface];
    const glm::uvec3 &f = s.face[face];
    out[0] = s.at(f.x), out[1] = s.at(f.y), out[2] = s.at(f.z);
  }

  Bounds bounds(std::uint32_t surface, std::uint32_t face) const {
    Triangle p;
    corners(surface, face, p);
    return bounds_of(p);
  }

  // Hash places a few faces wide, that divide periodic sides.
  void choose_places() {
    low_ = glm::dvec3(box_.lo[0], box_.lo[1], box_.lo[2]);
    glm::dvec3 high(box_.hi[0], box_.hi[1], box_.hi[2]);
    const bool open = !box_.periodic[0] || !box_.periodic[1] || !box_.periodic[2];
    double sum = 0;
    std::uint64_t faces = 0;
    for (std::uint32_t s = 0; s < surfaces_.size(); s++) {
      if (!result_.usable[s]) continue;
      for (std::uint32_t f = 0; f < surfaces_[s].faces; f += 61) {
        const Bounds b = bounds(s, f);
        const glm::dvec3 size = b.high - b.low;
        sum += std::max({size.x, size.y, size.z}), faces++;
      }
      for (std::uint32_t v = 0; open && v < surfaces_[s].vertices; v++) {
        const glm::dvec3 p = surfaces_[s].at(v);
        for (int axis = 0; axis < 3; axis++)
          if (!box_.periodic[axis])
            low_[axis] = std::min(low_[axis], p[axis] - margin_),
            high[axis] = std::max(high[axis], p[axis] + margin_);
      }
    }
    edge_ = faces ? std::max(kPlace * sum / double(faces) + margin_, 1e-3) : 1.0;
    for (int axis = 0; axis < 3; axis++) {
      const double side = high[axis] - low_[axis];
      places_[axis] = static_cast<int>(std::min(double(1 << 20), std::max(1.0, std::floor(side / edge_))));
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

  int lift_of(int place, int axis) const {
    return place >= 0 ? place / places_[axis] : -((places_[axis] - 1 - place) / places_[axis]);
  }

  template <class Use> void each_leaf(const Stretch &stretch, const Use &use) const {
    Leaf leaf;
    for (std::uint32_t f = stretch.first; f < stretch.last; f++) {
      const Bounds b = bounds(stretch.surface, f);
      Bounds grown = leaf.whole;
      grown.add(b);
      const glm::dvec3 size = grown.high - grown.low;
      if (leaf.count == kLeaf || (leaf.count && std::max({size.x, size.y, size.z}) > edge_)) {
        use(leaf);
        leaf.count = 0, grown = b;
      }
      if (leaf.count == 0) leaf.first = f;
      leaf.whole = grown, leaf.face[leaf.count++] = b;
    }
    if (leaf.count) use(leaf);
  }

  // The stretches with the layers that they reach, and how many leaves each layer holds.
  void list_stretches() {
    for (std::uint32_t s = 0; s < surfaces_.size(); s++)
      for (std::size_t f = 0; result_.usable[s] && f < surfaces_[s].faces; f += kStretch)
        stretch_.push_back({s, static_cast<std::uint32_t>(f),
                            static_cast<std::uint32_t>(std::min(f + kStretch, surfaces_[s].faces))});
    std::vector<std::vector<std::uint32_t>> counts(workers_.threads());
    for (auto &count : counts)
      count.resize(static_cast<std::size_t>(places_.z));
    workers_.loop(stretch_.size(), 64, [&](std::size_t i, unsigned worker) {
      Bounds whole;
      each_leaf(stretch_[i], [&](const Leaf &leaf) {
        whole.add(leaf.whole);
        const int from = place_of(leaf.whole.low - margin_).z, to = place_of(leaf.whole.high + margin_).z;
        for (int z = from; z <= to; z++)
          counts[worker][static_cast<std::size_t>(z - lift_of(z, 2) * places_.z)]++;
      });
      stretch_[i].low = place_of(whole.low - margin_).z, stretch_[i].high = place_of(whole.high + margin_).z;
    });
    layer_.resize(static_cast<std::size_t>(places_.z));
    for (const auto &count : counts)
      for (std::size_t z = 0; z < layer_.size(); z++)
        layer_[z] += count[z];
  }

  // Layers [first, end) whose leaves fit into the memory.
  int end_of_slab(int first) const {
    // A leaf counts in each of its layers, so this is on the safe side.
    const std::size_t most = options_.memory / (sizeof(Item) + 12 * sizeof(Item *));
    std::size_t sum = layer_[static_cast<std::size_t>(first)];
    int end = first + 1;
    while (end < places_.z && sum + layer_[static_cast<std::size_t>(end)] <= most)
      sum += layer_[static_cast<std::size_t>(end++)];
    return end;
  }

  bool meets_slab(const Stretch &stretch) const {
    for (int lift = lift_of(stretch.low, 2); lift <= lift_of(stretch.high, 2); lift++)
      if (stretch.low - lift * places_.z < slab_high_ && stretch.high - lift * places_.z >= slab_low_)
        return true;
    return false;
  }

  std::size_t place_number(int x, int y, int z) const {
    return (static_cast<std::size_t>(z - slab_low_) * static_cast<std::size_t>(places_.y) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(places_.x) +
           static_cast<std::size_t>(x);
  }

  // The places of an item that lie in the base box and in the slab.
  template <class Use> void each_place(const Item &item, const Use &use) const {
    const glm::ivec3 from = glm::max(item.first, glm::ivec3(0, 0, slab_low_)),
                     to = glm::min(item.last, glm::ivec3(places_.x - 1, places_.y - 1, slab_high_ - 1));
    for (int z = from.z; z <= to.z; z++)
      for (int y = from.y; y <= to.y; y++)
        for (int x = from.x; x <= to.x; x++)
          use(place_number(x, y, z));
  }

  void check_slab() {
    const std::size_t places = place_number(0, 0, slab_high_);
    start_ = std::make_unique<std::atomic<std::uint32_t>[]>(places + 1);
    marked_.clear();
    if (!all_changed_) {
      marked_.assign(places, 0);
      collect(true), collect(false);
    } else {
      collect(true);
    }
    std::uint32_t sum = 0;
    for (std::size_t p = 0; p <= places; p++)
      sum += start_[p], start_[p] = sum;
    entry_.resize(sum);
    // Each place ends where the next begins; filling backwards leaves its beginning.
    for (const Worker &from : worker_)
      workers_.loop(from.item.size(), 1024, [&](std::size_t i, unsigned) {
        each_place(from.item[i], [&](std::size_t p) {
          entry_[start_[p].fetch_sub(1, std::memory_order_relaxed) - 1] = &from.item[i];
        });
      });
    workers_.loop(places, 64, [&](std::size_t p, unsigned worker) {
      const std::size_t first = start_[p], last = start_[p + 1];
      if (first < last && (all_changed_ || marked_[p])) check_place(p, first, last, worker_[worker]);
    });
    for (Worker &worker : worker_)
      worker.item.clear();
  }

  // Leaves of the slab, counted at their places; of old surfaces only those near a new one.
  void collect(bool changed) {
    workers_.loop(stretch_.size(), 64, [&](std::size_t i, unsigned worker) {
      const Stretch &stretch = stretch_[i];
      if (!may_hold(stretch, changed) || !meets_slab(stretch)) return;
      each_leaf(stretch, [&](const Leaf &leaf) {
        const std::uint8_t faces = changed_faces(stretch.surface, leaf);
        if ((faces != 0) == changed) place_leaf(stretch.surface, leaf, faces, worker_[worker]);
      });
    });
  }

  // Can a leaf of the stretch have changed, or not have?
  bool may_hold(const Stretch &stretch, bool changed) const {
    if (changed_.surface[stretch.surface]) return changed;
    if (!changed) return true;
    return !changed_.face.empty() && changed_.face[stretch.surface].any_near(stretch.first, stretch.last);
  }

  std::uint8_t changed_faces(std::uint32_t surface, const Leaf &leaf) const {
    unsigned faces = 0;
    for (std::uint32_t f = 0; f < leaf.count; f++)
      faces |= static_cast<unsigned>(changed_.holds(surface, leaf.first + f)) << f;
    return static_cast<std::uint8_t>(faces);
  }

  void place_leaf(std::uint32_t surface, const Leaf &leaf, std::uint8_t changed, Worker &worker) {
    const glm::ivec3 from = place_of(leaf.whole.low - margin_), to = place_of(leaf.whole.high + margin_);
    for (int lz = lift_of(from.z, 2); lz <= lift_of(to.z, 2); lz++) {
      if (from.z - lz * places_.z >= slab_high_ || to.z - lz * places_.z < slab_low_) continue;
      for (int ly = lift_of(from.y, 1); ly <= lift_of(to.y, 1); ly++)
        for (int lx = lift_of(from.x, 0); lx <= lift_of(to.x, 0); lx++) {
          const glm::ivec3 lift(lx, ly, lz);
          Item item = {};
          item.first = from - lift * places_, item.last = to - lift * places_;
          if (!changed && !near_changed(item)) continue;
          fill(item, surface, leaf, lift);
          item.changed = changed;
          each_place(item, [&](std::size_t p) {
            start_[p].fetch_add(1, std::memory_order_relaxed);
            if (changed && !marked_.empty()) __atomic_store_n(&marked_[p], 1, __ATOMIC_RELAXED);
          });
          worker.item.add(item);
        }
    }
  }

  bool near_changed(const Item &item) const {
    bool found = false;
    each_place(item, [&](std::size_t p) { found |= marked_[p] != 0; });
    return found;
  }

  void fill(Item &item, std::uint32_t surface, const Leaf &leaf, const glm::ivec3 &lift) const {
    item.surface = surface, item.face = leaf.first, item.count = leaf.count;
    const glm::dvec3 shift = low_ + glm::dvec3(lift) * side_;
    const auto down = [](double v) { return static_cast<float>(v - 1e-7 * (1 + std::fabs(v))); };
    const auto up = [](double v) { return static_cast<float>(v + 1e-7 * (1 + std::fabs(v))); };
    for (int axis = 0; axis < 3; axis++) {
      item.lift[axis] = static_cast<std::int16_t>(lift[axis]);
      item.low[axis] = down(leaf.whole.low[axis] - shift[axis]);
      item.high[axis] = up(leaf.whole.high[axis] - shift[axis]);
      for (std::uint32_t f = 0; f < kLeaf; f++) {
        item.face_low[axis][f] = f < leaf.count ? down(leaf.face[f].low[axis] - shift[axis]) : 1e30f;
        item.face_high[axis][f] = f < leaf.count ? up(leaf.face[f].high[axis] - shift[axis]) : -1e30f;
      }
    }
  }

  void check_place(std::size_t place, std::size_t first, std::size_t last, Worker &worker) const {
    const auto nx = static_cast<std::size_t>(places_.x), ny = static_cast<std::size_t>(places_.y);
    const glm::ivec3 here(static_cast<int>(place % nx), static_cast<int>(place / nx % ny),
                          static_cast<int>(place / (nx * ny)) + slab_low_);
    const float reach = static_cast<float>(options_.reach * (1 + 1e-6));
    for (std::size_t i = first; i < last; i++) {
      const Item &a = *entry_[i];
      if (a.first == here && a.changed) check_faces(a, a, true, worker);
      for (std::size_t j = i + 1; j < last; j++) {
        const Item &b = *entry_[j];
        if (!a.changed && !b.changed) continue;
        const bool same = a.surface == b.surface && std::equal(a.lift, a.lift + 3, b.lift);
        const float far = same ? 0 : reach;
        if (a.low[0] - b.high[0] > far || b.low[0] - a.high[0] > far || a.low[1] - b.high[1] > far ||
            b.low[1] - a.high[1] > far || a.low[2] - b.high[2] > far || b.low[2] - a.high[2] > far)
          continue;
        // Each pair once: in the place of the lower corner of what the two boxes share.
        if (glm::max(a.first, b.first) == here) check_faces(a, b, same, worker);
      }
    }
  }

  void check_faces(const Item &a, const Item &b, bool same, Worker &worker) const {
    // What is farther than the gaps found so far tells nothing new.
    const double bound2 = std::max({worker.gap2[a.surface], worker.gap2[b.surface], least2_});
    BoxPairs pairs;
    compare_boxes(a, b, same ? 0 : static_cast<float>(std::sqrt(bound2) * (1 + 1e-6)), pairs);
    const std::uint64_t of_b = bytes_of(b.changed);
    for (std::uint32_t i = 0; i < a.count; i++) {
      std::uint64_t meet, near, wanted = a.changed >> i & 1 ? ~std::uint64_t(0) : of_b;
      std::memcpy(&meet, pairs.meet[i], 8), std::memcpy(&near, pairs.near[i], 8);
      if (&a == &b) wanted &= i == kLeaf - 1 ? 0 : ~std::uint64_t(0) << 8 * (i + 1);
      worker.pairs += static_cast<unsigned>(__builtin_popcountll(meet & wanted));
      for (near &= wanted; near; near &= near - 1)
        check_pair(a, a.face + i, b, b.face + static_cast<std::uint32_t>(__builtin_ctzll(near) / 8), worker);
    }
  }

  // A byte of ones for each bit.
  static std::uint64_t bytes_of(std::uint8_t bits) {
    if (bits == 0xff) return ~std::uint64_t(0);
    std::uint64_t bytes = 0;
    for (unsigned i = 0; i < kLeaf; i++)
      if (bits >> i & 1) bytes |= std::uint64_t(0xff) << 8 * i;
    return bytes;
  }

  // In an order of their own, whatever order they came in.
  void check_pair(const Item &a, std::uint32_t face, const Item &b, std::uint32_t other,
                  Worker &worker) const {
    const glm::ivec3 lift(a.lift[0] - b.lift[0], a.lift[1] - b.lift[1], a.lift[2] - b.lift[2]);
    const bool turn = a.surface != b.surface ? b.surface < a.surface
                      : face != other        ? other < face
                      : lift.z != 0          ? lift.z < 0
                      : lift.y != 0          ? lift.y < 0
                                             : lift.x < 0;
    if (turn)
      judge({Flaw::near, b.surface, other, a.surface, face, -lift, {}}, worker);
    else
      judge({Flaw::near, a.surface, face, b.surface, other, lift, {}}, worker);
  }

  void judge(Defect pair, Worker &worker) const {
    if (pair.surface == pair.other_surface && pair.lift == glm::ivec3(0)) {
      judge_neighbours(pair, worker);
      return;
    }
    Triangle p, q;
    corners(pair.surface, pair.face, p);
    corners(pair.other_surface, pair.other_face, q);
    for (glm::dvec3 &corner : q)
      corner += glm::dvec3(pair.lift) * side_;
    double &gap2 = worker.gap2[pair.surface], &other_gap2 = worker.gap2[pair.other_surface];
    const double bound2 = std::max({gap2, other_gap2, least2_});
    if (is_beside(p, q, bound2) || is_beside(q, p, bound2)) return;
    if (meet(p, q)) {
      gap2 = other_gap2 = 0;
      pair.flaw = pair.surface == pair.other_surface ? Flaw::crossing_image : Flaw::crossing_cells;
      add(pair, p, q, worker);
      return;
    }
    const double distance2 = triangle_distance2(p, q);
    gap2 = std::min(gap2, distance2), other_gap2 = std::min(other_gap2, distance2);
    if (distance2 < least2_) add(pair, p, q, worker);
  }

  // Faces of one surface: common vertices (by number) come first, then what else they share is asked.
  void judge_neighbours(Defect &pair, Worker &worker) const {
    const SurfaceView &s = surfaces_[pair.surface];
    const Bits &plain = result_.plain[pair.surface];
    glm::uvec3 f = s.face[pair.face], g = s.face[pair.other_face];
    for (int i = 0; i < 3; i++)
      if (((f[i] == g.x) | (f[i] == g.y) | (f[i] == g.z)) && plain[f[i]]) return;
    int common = 0;
    for (int i = 0; i < 3; i++)
      for (int j = common; j < 3; j++)
        if (i >= common && f[i] == g[j]) {
          std::swap(f[common], f[i]), std::swap(g[common], g[j]);
          common++;
          break;
        }
    const Triangle p = {s.at(f.x), s.at(f.y), s.at(f.z)}, q = {s.at(g.x), s.at(g.y), s.at(g.z)};
    if (common == 0   ? !meet(p, q)
        : common == 1 ? !meet_beyond_vertex(p, q)
        : common == 2 ? !meet_beyond_edge(p, q)
                      : false)
      return;
    pair.flaw = common ? Flaw::fold : Flaw::crossing_self;
    add(pair, p, q, worker);
  }

  static bool meet(const Triangle &p, const Triangle &q) {
    return !is_beside(p, q, 0) && !is_beside(q, p, 0) && triangles_meet(p, q);
  }

  // All of q lies clearly on one side of the plane of p, no nearer than sqrt(bound2).
  static bool is_beside(const Triangle &p, const Triangle &q, double bound2) {
    const glm::dvec3 e = p[1] - p[0], f = p[2] - p[0], normal = cross_product(e, f);
    const glm::dvec3 w0 = q[0] - p[0], w1 = q[1] - p[0], w2 = q[2] - p[0];
    const double d0 = glm::dot(normal, w0), d1 = glm::dot(normal, w1), d2 = glm::dot(normal, w2);
    const double low = std::min({d0, d1, d2}), high = std::max({d0, d1, d2});
    const double nearest = low > 0 ? low : high < 0 ? -high : 0;
    const double doubt2 = kClearly * kClearly * glm::dot(e, e) * glm::dot(f, f) *
                          std::max({glm::dot(w0, w0), glm::dot(w1, w1), glm::dot(w2, w2)});
    return nearest * nearest > std::max(doubt2, bound2 * glm::dot(normal, normal) * (1 + 1e-9));
  }

  static Bounds bounds_of(const Triangle &p) {
    return {glm::min(glm::min(p[0], p[1]), p[2]), glm::max(glm::max(p[0], p[1]), p[2])};
  }

  void add(Defect &pair, const Triangle &p, const Triangle &q, Worker &worker) const {
    const Bounds a = bounds_of(p), b = bounds_of(q);
    pair.where = 0.5 * (glm::max(a.low, b.low) + glm::min(a.high, b.high)); // amid what their boxes share
    worker.found.push_back(pair);
  }

  const Views &surfaces_;
  const Changed &changed_;
  const conceg_box &box_;
  const CheckOptions &options_;
  Workers &workers_;
  const Progress &progress_;
  CheckResult &result_;
  double margin_, least2_, edge_ = 1;
  bool all_changed_;
  glm::dvec3 low_{}, inverse_{}, side_{};
  glm::ivec3 places_{1};
  std::vector<Stretch> stretch_;
  std::vector<std::size_t> layer_; // leaves of each layer of places
  int slab_low_ = 0, slab_high_ = 0;
  std::unique_ptr<std::atomic<std::uint32_t>[]> start_; // of each place of the slab
  std::vector<const Item *> entry_;
  std::vector<std::uint8_t> marked_; // places with a leaf that is new; empty: all are
  std::vector<Worker> worker_;
};

} // namespace

void check_pairs(const Views &surfaces, const Changed &changed, const conceg_box &box,
                 const CheckOptions &options, Workers &workers, const Progress &progress,
                 CheckResult &result) {
  PairCheck(surfaces, changed, box, options, workers, progress, result).run();
}

} // namespace conceg::mesh
