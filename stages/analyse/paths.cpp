// SPDX-License-Identifier: BSD-3-Clause
#include "paths.hpp"

#include "conceg/rng.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <utility>

namespace conceg::analyse {

namespace {

constexpr float far = std::numeric_limits<float>::infinity();
constexpr long straight = 3; // voxels around the start whose distance is taken as a straight line

// Voxels by length, the nearest first, equal ones by place. They wait in layers, of which the nearest alone
// is held as a heap. What is put must lie within `reach` of what was taken last.
class Front {
public:
  Front(double reach, double thick) : thick_(thick), layer_(static_cast<std::size_t>(reach / thick) + 2) {}
  void put(float length, std::size_t i) {
    std::uint32_t bits; // of a float from 0 on: they grow with its value
    std::memcpy(&bits, &length, sizeof bits);
    const auto layer = static_cast<std::size_t>(static_cast<double>(length) / thick_);
    std::vector<std::uint64_t> &to = layer_[layer % layer_.size()];
    to.push_back(static_cast<std::uint64_t>(bits) << 32 | i), count_++;
    if (layer <= now_) std::push_heap(to.begin(), to.end(), std::greater<>());
  }
  bool empty() const { return count_ == 0; }
  std::pair<float, std::size_t> take() {
    while (layer_[now_ % layer_.size()].empty()) {
      std::vector<std::uint64_t> &next = layer_[++now_ % layer_.size()];
      std::make_heap(next.begin(), next.end(), std::greater<>());
    }
    std::vector<std::uint64_t> &from = layer_[now_ % layer_.size()];
    std::pop_heap(from.begin(), from.end(), std::greater<>());
    const std::uint64_t key = from.back();
    from.pop_back(), count_--;
    const auto bits = static_cast<std::uint32_t>(key >> 32);
    float length;
    std::memcpy(&length, &bits, sizeof length);
    return {length, key & 0xffffffffu};
  }

private:
  double thick_;
  std::vector<std::vector<std::uint64_t>> layer_; // a ring
  std::size_t now_ = 0, count_ = 0;
};

// Voxels that a search is to reach: it may end when the last one has its length.
class Goals {
public:
  Goals(std::size_t voxels, const std::vector<std::size_t> &goals) : is_(goals.empty() ? 0 : voxels, 0) {
    for (const std::size_t g : goals)
      left_ += !is_[g], is_[g] = 1;
  }
  // True when that was the last one; never without goals.
  bool reached(std::size_t i) {
    if (is_.empty() || !is_[i]) return false;
    is_[i] = 0;
    return --left_ == 0;
  }

private:
  std::vector<std::uint8_t> is_;
  std::size_t left_ = 0;
};

// The larger root of sum a_k (t - b_k)^2 = 1 over the terms, which are dropped from the last one on where t
// would not lie behind them.
struct Term {
  double weight, base, nearest;
};
double solved(std::array<Term, 3> &terms) {
  const auto order = [&](std::size_t i, std::size_t j) {
    if (terms[j].nearest < terms[i].nearest) std::swap(terms[i], terms[j]);
  };
  order(0, 1), order(1, 2), order(0, 1);
  double best = std::numeric_limits<double>::infinity();
  double a = 0, b = 0, c = -1;
  for (const Term &t : terms) {
    if (t.nearest >= best) break; // also the terms of axes without a settled neighbour
    a += t.weight, b += t.weight * t.base, c += t.weight * t.base * t.base;
    const double root = b * b - a * c;
    if (root < 0) break;
    best = (b + std::sqrt(root)) / a;
  }
  return best;
}

// Steps of one and two voxels along each axis: number 4 axis + 2 (far) + (up).
std::vector<Steps::Step> marching_steps() {
  std::vector<Steps::Step> out;
  for (std::size_t axis = 0; axis < 3; axis++)
    for (const long by : {-1L, 1L, -2L, 2L}) {
      out.push_back({0, 0, 0});
      out.back()[axis] = by;
    }
  return out;
}

std::vector<Steps::Step> box_around(const OpenVoxels &v, long most) {
  std::array<long, 3> reach = {};
  for (std::size_t a = 0; a < 3; a++)
    reach[a] = v.shape[a] == 1 ? 0 : std::min(most, static_cast<long>(v.shape[a] - 1) / 2);
  std::vector<Steps::Step> out;
  for (long x = -reach[0]; x <= reach[0]; x++)
    for (long y = -reach[1]; y <= reach[1]; y++)
      for (long z = -reach[2]; z <= reach[2]; z++)
        if (x || y || z) out.push_back({x, y, z});
  return out;
}

// True when all voxels that a straight line between two voxels near each other can touch are open.
bool all_open(const OpenVoxels &v, const Steps &steps, std::size_t from, const Steps::Step &by) {
  std::array<long, 3> lo = {}, hi = {};
  for (std::size_t a = 0; a < 3; a++)
    lo[a] = std::min(0L, by[a]), hi[a] = std::max(0L, by[a]);
  for (long x = lo[0]; x <= hi[0]; x++)
    for (long y = lo[1]; y <= hi[1]; y++)
      for (long z = lo[2]; z <= hi[2]; z++)
        if (const std::size_t j = steps.over_faces(from, {x, y, z}); j == Steps::outside || !v.open[j])
          return false;
  return true;
}

} // namespace

PathFinder::PathFinder(const OpenVoxels &voxels, Workers &workers, int neighbours)
    : voxels_(voxels), march_(voxels, marching_steps(), 2),
      near_(voxels,
            Steps::around(voxels, neighbours == 6    ? 1
                                  : neighbours == 18 ? 2
                                                     : 3),
            1),
      straight_(voxels, box_around(voxels, straight), straight), allowed_(voxels.open.size(), 0) {
  std::vector<std::uint32_t> touched(near_.count(),
                                     0); // per step: bits of those to all voxels that it touches
  for (std::size_t k = 0; k < near_.count(); k++)
    for (std::size_t n = 0; n < near_.count(); n++) {
      bool within = true;
      for (std::size_t a = 0; a < 3; a++)
        within = within && (near_.step(n)[a] == 0 || near_.step(n)[a] == near_.step(k)[a]);
      if (within) touched[k] |= 1u << n;
    }
  workers.loop(allowed_.size(), 1 << 14, [&](std::size_t i, unsigned) {
    if (!voxels_.open[i]) return;
    std::uint32_t open = 0;
    near_.from(
        i, [&](std::size_t j, std::size_t k) { open |= static_cast<std::uint32_t>(voxels_.open[j]) << k; });
    for (std::size_t k = 0; k < near_.count(); k++)
      if ((open & touched[k]) == touched[k]) allowed_[i] |= 1u << k;
  });
}

// Length at a voxel from the settled ones around it; those have a length in `settled`, others infinity.
double PathFinder::length_at(const std::vector<float> &settled, std::size_t i) const {
  constexpr Term nothing = {0, 0, std::numeric_limits<double>::infinity()};
  std::array<Term, 3> terms = {nothing, nothing, nothing};
  for (std::size_t axis = 0; axis < 3; axis++) {
    if (voxels_.shape[axis] == 1) continue;
    Term &best = terms[axis];
    const double h = voxels_.spacing[axis];
    for (std::size_t side = 0; side < 2; side++) {
      const std::size_t one = march_.to(i, 4 * axis + side);
      if (one == Steps::outside || !(settled[one] < far)) continue;
      const auto near = static_cast<double>(settled[one]);
      if (near >= best.nearest) continue;
      best = {1 / (h * h), near, near};
      const std::size_t two = march_.to(i, 4 * axis + 2 + side);
      if (two != Steps::outside && settled[two] <= settled[one]) { // (3 t - 4 near + beyond) / (2 h)
        const auto beyond = static_cast<double>(settled[two]);
        best = {2.25 / (h * h), (4 * near - beyond) / 3, near};
      }
    }
  }
  return solved(terms);
}

std::vector<float> PathFinder::marched(std::size_t start, const std::vector<std::size_t> &goals) const {
  std::vector<float> settled(voxels_.open.size(), far), length(settled.size());
  for (std::size_t i = 0; i < length.size(); i++)
    length[i] = voxels_.open[i] ? far : 0.0f; // nothing is less
  const double widest = largest_spacing(voxels_);
  Front front(2 * std::sqrt(3.0) * straight * widest, 0.25 * widest);
  Goals left(voxels_.open.size(), goals);
  const auto offer = [&](std::size_t i, double value) {
    if (!(static_cast<float>(value) < length[i])) return;
    length[i] = static_cast<float>(value);
    front.put(length[i], i);
  };
  offer(start, 0);
  straight_.from(start, [&](std::size_t j, std::size_t k) {
    if (all_open(voxels_, straight_, start, straight_.step(k))) offer(j, straight_.length(k));
  });
  while (!front.empty()) {
    const auto [value, i] = front.take();
    if (settled[i] < far) continue;
    settled[i] = value;
    if (left.reached(i)) break;
    for (std::size_t axis = 0; axis < 3; axis++)
      for (std::size_t side = 0; voxels_.shape[axis] > 1 && side < 2; side++) {
        const std::size_t j = march_.to(i, 4 * axis + side);
        if (j == Steps::outside || !(value < length[j])) continue; // settled, closed, or as near already
        // Where the neighbour on the other side was settled before, it is nearer: nothing changes.
        const std::size_t other = march_.to(j, 4 * axis + side);
        if (other != Steps::outside && other != i && settled[other] < value) continue;
        offer(j, std::max(static_cast<double>(value), length_at(settled, j)));
      }
  }
  return settled;
}

// Dijkstra's search. Voxels wait in layers as thick as the shortest step, so what is taken from one layer
// adds to later ones only, and the order within a layer does not matter (Dial 1969).
std::vector<float> PathFinder::stepped(std::size_t start, const std::vector<std::size_t> &goals) const {
  std::vector<float> length(voxels_.open.size(), far);
  if (!voxels_.open[start] || !near_.count()) return length;
  double thick = near_.length(0), longest = 0;
  for (std::size_t k = 0; k < near_.count(); k++)
    thick = std::min(thick, near_.length(k)), longest = std::max(longest, near_.length(k));
  const auto layer_of = [&](float at) { return static_cast<std::size_t>(static_cast<double>(at) / thick); };
  std::vector<std::vector<std::uint32_t>> waiting(static_cast<std::size_t>(longest / thick) + 2);
  Goals left(voxels_.open.size(), goals);
  length[start] = 0, waiting[0].push_back(static_cast<std::uint32_t>(start));
  std::size_t count = 1; // voxels that wait
  bool all_reached = false;
  for (std::size_t layer = 0; count && !all_reached; layer++) {
    std::vector<std::uint32_t> &now = waiting[layer % waiting.size()];
    for (std::size_t n = 0; n < now.size(); n++) { // rounding may add to the same layer
      const std::size_t i = now[n];
      count--;
      const float value = length[i];
      if (layer_of(value) < layer) continue; // taken before, by a shorter way
      all_reached = left.reached(i) || all_reached;
      for (std::uint32_t steps = allowed_[i]; steps; steps &= steps - 1) {
        const auto k = static_cast<std::size_t>(__builtin_ctz(steps));
        const std::size_t j = near_.to(i, k);
        const auto there = static_cast<float>(static_cast<double>(value) + near_.length(k));
        if (!(there < length[j])) continue;
        length[j] = there;
        waiting[layer_of(there) % waiting.size()].push_back(static_cast<std::uint32_t>(j)), count++;
      }
    }
    now.clear();
  }
  return length;
}

std::vector<float> marched_lengths(const OpenVoxels &voxels, std::size_t start) {
  Workers alone(1);
  return PathFinder(voxels, alone).marched(start, {});
}

std::vector<float> stepped_lengths(const OpenVoxels &voxels, std::size_t start, int neighbours) {
  Workers alone(1);
  return PathFinder(voxels, alone, neighbours).stepped(start, {});
}

namespace {

// Shortest distance between two voxels, over the faces of periodic axes, um.
double apart(const OpenVoxels &v, std::size_t i, std::size_t j) {
  const auto [nx, ny, nz] = v.shape;
  const std::array<std::size_t, 3> p = {i / (ny * nz), i / nz % ny, i % nz},
                                   q = {j / (ny * nz), j / nz % ny, j % nz};
  double squared = 0;
  for (std::size_t a = 0; a < 3; a++) {
    const auto n = static_cast<double>(v.shape[a]);
    double d = static_cast<double>(q[a]) - static_cast<double>(p[a]);
    if (v.periodic[a]) d -= n * std::round(d / n);
    squared += std::pow(d * v.spacing[a], 2);
  }
  return std::sqrt(squared);
}

// Are there pairs that far apart? Over the faces of a periodic axis none is farther than half a side.
bool wide_enough(const OpenVoxels &v, double least) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; a++)
    if (v.shape[a] > 1)
      shortest =
          std::min(shortest, v.spacing[a] * static_cast<double>(v.shape[a]) * (v.periodic[a] ? 0.5 : 1));
  return least < shortest;
}

// The pairs of one start: lengths of those that are joined.
struct OfStart {
  std::vector<double> marched, stepped; // Euclidean distance over path
  std::uint64_t pairs = 0, apart = 0;
};

OfStart from_start(const OpenVoxels &voxels, const PathFinder &finder, const std::vector<std::uint32_t> &open,
                   const PathSettings &settings, std::uint64_t number) {
  conceg_rng rng = conceg_rng_stream(settings.seed, "analyse.paths", number);
  const std::size_t start = open[conceg_rng_below(&rng, open.size())];
  std::vector<std::size_t> goals;
  for (std::uint64_t tries = 0; tries < 100 * settings.ends && goals.size() < settings.ends; tries++) {
    const std::size_t end = open[conceg_rng_below(&rng, open.size())];
    if (apart(voxels, start, end) >= settings.least) goals.push_back(end);
  }
  OfStart out;
  out.pairs = goals.size();
  if (goals.empty()) return out;
  const std::vector<float> marched = finder.marched(start, goals), stepped = finder.stepped(start, goals);
  for (const std::size_t end : goals) {
    const double euclid = apart(voxels, start, end);
    if (!(marched[end] < far)) {
      out.apart++;
      continue;
    }
    out.marched.push_back(std::min(1.0, euclid / static_cast<double>(marched[end])));
    out.stepped.push_back(euclid / static_cast<double>(stepped[end]));
  }
  return out;
}

} // namespace

PathStraightness path_straightness(const std::vector<OpenVoxels> &media, const PathSettings &settings,
                                   Workers &workers, const Progress &progress) {
  PathStraightness out;
  std::vector<double> marched, stepped;
  std::uint64_t done = 0;
  for (std::size_t m = 0; m < media.size(); m++) {
    report(progress, "paths", m, media.size());
    const OpenVoxels &voxels = media[m];
    // Starts are dealt out to the media in turn.
    const std::uint64_t starts = (settings.starts + media.size() - 1 - m) / media.size();
    std::vector<std::uint32_t> open;
    for (std::size_t i = 0; i < voxels.open.size(); i++)
      if (voxels.open[i]) open.push_back(static_cast<std::uint32_t>(i));
    if (open.empty() || !starts || !wide_enough(voxels, settings.least)) continue;
    const PathFinder finder(voxels, workers);
    std::vector<OfStart> found(starts);
    workers.loop(found.size(), 1, [&](std::size_t s, unsigned) {
      found[s] = from_start(voxels, finder, open, settings, done + s);
    });
    done += starts;
    for (const OfStart &f : found) {
      marched.insert(marched.end(), f.marched.begin(), f.marched.end());
      stepped.insert(stepped.end(), f.stepped.begin(), f.stepped.end());
      out.pairs += f.pairs, out.apart += f.apart;
    }
  }
  out.marched = distribution(std::move(marched)), out.stepped = distribution(std::move(stepped));
  return out;
}

} // namespace conceg::analyse
