// SPDX-License-Identifier: BSD-3-Clause
#include "pore_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace conceg::analyse {

namespace {

constexpr float none = std::numeric_limits<float>::infinity();
constexpr double prominence = 0.5;    // of a voxel: lower maxima are noise of the grid
constexpr double medial_slope = 0.70; // of the radius; on the medial surface no neighbour's is steeper

double voxel_of(const OpenVoxels &v) {
  double product = 1;
  int axes = 0;
  for (std::size_t a = 0; a < 3; a++)
    if (v.shape[a] > 1) product *= v.spacing[a], axes++;
  return axes ? std::pow(product, 1.0 / axes) : v.spacing[0];
}

// Squared distances along one line: lower envelope of the parabolas of all points and, on a periodic line, of
// their images on both sides (Felzenszwalb and Huttenlocher 2012).
class LineTransform {
public:
  void operator()(std::vector<float> &f, double step, bool periodic) {
    const auto n = static_cast<long>(f.size());
    apex_.clear(), from_.clear();
    const auto value = [&](long i) {
      return static_cast<double>(f[static_cast<std::size_t>(((i % n) + n) % n)]);
    };
    for (long i = periodic ? -n : 0; i < (periodic ? 2 * n : n); i++) {
      if (!(value(i) < none)) continue;
      double at = -std::numeric_limits<double>::infinity();
      while (!apex_.empty()) {
        const long j = apex_.back();
        at = 0.5 * static_cast<double>(i + j) +
             (value(i) - value(j)) / (2 * step * step * static_cast<double>(i - j));
        if (at > from_.back()) break;
        apex_.pop_back(), from_.pop_back();
      }
      if (apex_.empty()) at = -std::numeric_limits<double>::infinity();
      apex_.push_back(i), from_.push_back(at);
    }
    if (apex_.empty()) return;
    out_.resize(f.size());
    std::size_t k = 0;
    for (long i = 0; i < n; i++) {
      while (k + 1 < apex_.size() && from_[k + 1] <= static_cast<double>(i))
        k++;
      const double apart = step * static_cast<double>(i - apex_[k]);
      out_[static_cast<std::size_t>(i)] = static_cast<float>(value(apex_[k]) + apart * apart);
    }
    f = out_;
  }

private:
  std::vector<long> apex_;
  std::vector<double> from_;
  std::vector<float> out_;
};

// Open voxels as numbers that sort from the widest to the narrowest, equal ones by place.
class ByRadius {
public:
  ByRadius(const OpenVoxels &v, const std::vector<float> &radius) {
    for (std::size_t i = 0; i < v.open.size(); i++)
      if (v.open[i]) key_.push_back(key(radius[i]) << 32 | i);
    std::sort(key_.begin(), key_.end());
  }
  std::size_t count() const { return key_.size(); }
  std::size_t operator[](std::size_t k) const { return key_[k] & 0xffffffffu; }

private:
  // Bits of a float from 0 on grow with its value.
  static std::uint64_t key(float radius) {
    std::uint32_t bits;
    std::memcpy(&bits, &radius, sizeof bits);
    return 0xffffffffu - bits;
  }
  std::vector<std::uint64_t> key_;
};

// Distance from a voxel's centre to the nearest face of an axis that is not periodic, um.
class FaceDistance {
public:
  explicit FaceDistance(const OpenVoxels &v) : v_(v) {
    for (std::size_t a = 0; a < 3; a++)
      open_ = open_ || (!v.periodic[a] && v.shape[a] > 1);
  }
  double operator()(std::size_t i) const {
    double least = std::numeric_limits<double>::infinity();
    if (!open_) return least;
    const auto [nx, ny, nz] = v_.shape;
    const std::array<std::size_t, 3> at = {i / (ny * nz), i / nz % ny, i % nz};
    for (std::size_t a = 0; a < 3; a++)
      if (!v_.periodic[a] && v_.shape[a] > 1)
        least = std::min(least, (static_cast<double>(std::min(at[a], v_.shape[a] - 1 - at[a])) + 0.5) *
                                    v_.spacing[a]);
    return least;
  }

private:
  const OpenVoxels &v_;
  bool open_ = false;
};

// Maxima that stand out: voxels are flooded from the widest on; where two floods meet the lower one ends, and
// counts when its top is that much above the meeting.
std::vector<std::size_t> maxima(const OpenVoxels &v, const Steps &steps, const std::vector<float> &radius,
                                const ByRadius &order) {
  const double least = prominence * voxel_of(v);
  constexpr std::uint32_t dry = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> top(v.open.size(), dry); // union-find; the root is the top of its flood
  const auto find = [&](std::uint32_t i) {
    while (top[i] != i)
      i = top[i] = top[top[i]];
    return i;
  };
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < order.count(); k++) {
    const auto i = static_cast<std::uint32_t>(order[k]);
    top[i] = i;
    steps.from(i, [&](std::size_t j, std::size_t) {
      if (top[j] == dry) return;
      std::uint32_t a = find(i), b = find(static_cast<std::uint32_t>(j));
      if (a == b) return;
      if (radius[a] < radius[b] || (radius[a] == radius[b] && a > b)) std::swap(a, b);
      if (b != i && static_cast<double>(radius[b]) - static_cast<double>(radius[i]) >= least)
        out.push_back(b);
      top[b] = a;
    });
  }
  for (std::size_t k = 0; k < order.count(); k++)
    if (top[order[k]] == order[k]) out.push_back(order[k]); // the highest of each piece
  return out;
}

// Largest slope of the radius from each open voxel to one of its neighbours, in the given order.
std::vector<float> slopes(const Steps &steps, const std::vector<float> &radius, const ByRadius &order,
                          Workers &workers) {
  std::vector<float> out(order.count());
  workers.loop(order.count(), 4096, [&](std::size_t k, unsigned) {
    const std::size_t i = order[k];
    double slope = -std::numeric_limits<double>::infinity();
    steps.from(i, [&](std::size_t j, std::size_t step) {
      slope = std::max(slope, (static_cast<double>(radius[j]) - static_cast<double>(radius[i])) /
                                  steps.length(step));
    });
    out[k] = static_cast<float>(slope);
  });
  return out;
}

// Paints balls, the largest first, so that each voxel is painted once; a ball within a neighbour's adds
// nothing. Slabs across x are painted apart from one another, as the colour does not depend on the order.
class Painter {
public:
  Painter(const OpenVoxels &v, const std::vector<float> &radius, std::vector<float> &thick)
      : v_(v), radius_(radius), thick_(thick), next_(v.shape[2] ? v.open.size() : 0) {}

  void slab(long from, long to, const ByRadius &order, const std::vector<float> &slope) {
    const auto [nx, ny, nz] = v_.shape;
    std::uint64_t left = 0; // voxels without a colour
    for (std::size_t i = static_cast<std::size_t>(from) * ny * nz; i < static_cast<std::size_t>(to) * ny * nz;
         i++) {
      const bool open = v_.open[i] != 0;
      next_[i] = static_cast<std::uint32_t>(open ? i % nz : i % nz + 1), left += open;
    }
    for (std::size_t k = 0; k < order.count() && left; k++) {
      const std::size_t i = order[k], x = i / (ny * nz);
      const long centre = static_cast<long>(x), reach = reach_of(0, i);
      const bool near = v_.periodic[0] || (centre + reach >= from && centre - reach < to);
      if (!near || slope[k] >= 1 - 1e-6f) {
        if (centre >= from && centre < to && paint(x, i / nz % ny, i % nz, i % nz + 1, radius_[i])) left--;
        continue;
      }
      for (long dx = -reach; dx <= reach; dx++) {
        const long at = wrapped(0, centre + dx);
        if (at >= from && at < to) left -= ball_plane(i, dx, static_cast<std::size_t>(at));
      }
    }
  }

private:
  static constexpr long outside = -1;
  long reach_of(std::size_t a, std::size_t i) const {
    return v_.shape[a] == 1 ? 0 : static_cast<long>(static_cast<double>(radius_[i]) / v_.spacing[a]);
  }
  long wrapped(std::size_t a, long at) const {
    const long n = static_cast<long>(v_.shape[a]);
    if (at >= 0 && at < n) return at;
    return v_.periodic[a] ? ((at % n) + n) % n : outside;
  }
  std::uint64_t ball_plane(std::size_t i, long dx, std::size_t x) {
    const auto [nx, ny, nz] = v_.shape;
    const long y = static_cast<long>(i / nz % ny), z = static_cast<long>(i % nz),
               deep = static_cast<long>(nz);
    const double r = static_cast<double>(radius_[i]), a = static_cast<double>(dx) * v_.spacing[0];
    std::uint64_t painted = 0;
    const long reach = reach_of(1, i);
    for (long dy = -reach; dy <= reach; dy++) {
      const long row = wrapped(1, y + dy);
      const double b = static_cast<double>(dy) * v_.spacing[1], left = r * r - a * a - b * b;
      if (row == outside || left < 0) continue;
      const long half = nz == 1 ? 0 : static_cast<long>(std::sqrt(left) / v_.spacing[2]);
      const auto span = [&](long lo, long hi) { // [lo, hi) within the row
        if (lo < hi)
          painted += paint(x, static_cast<std::size_t>(row), static_cast<std::size_t>(lo),
                           static_cast<std::size_t>(hi), radius_[i]);
      };
      const long lo = z - half, hi = z + half + 1;
      if (hi - lo >= deep && v_.periodic[2]) {
        span(0, deep);
        continue;
      }
      span(std::max(0L, lo), std::min(deep, hi));
      if (v_.periodic[2]) span(std::max(0L, lo + deep), lo < 0 ? deep : 0), span(0, hi - deep);
    }
    return painted;
  }
  // Colours what has none yet in one row; how many those were.
  std::uint64_t paint(std::size_t x, std::size_t y, std::size_t lo, std::size_t hi, float colour) {
    const std::size_t first = (x * v_.shape[1] + y) * v_.shape[2];
    std::uint64_t painted = 0;
    for (std::size_t z = free_from(first, lo); z < hi; z = free_from(first, z + 1)) {
      thick_[first + z] = colour, next_[first + z] = static_cast<std::uint32_t>(z + 1);
      painted++;
    }
    return painted;
  }
  // The first voxel from z on without a colour; the length of the row when there is none.
  std::size_t free_from(std::size_t first, std::size_t z) {
    std::size_t end = z;
    while (end < v_.shape[2] && next_[first + end] != end)
      end = next_[first + end];
    while (z < end) { // shortens the way for the next time
      const std::size_t then = next_[first + z];
      next_[first + z] = static_cast<std::uint32_t>(end), z = then;
    }
    return end;
  }

  const OpenVoxels &v_;
  const std::vector<float> &radius_;
  std::vector<float> &thick_;
  std::vector<std::uint32_t> next_; // per voxel: itself when it has no colour, else a later one, along z
};

std::vector<float> thicknesses(const OpenVoxels &v, const std::vector<float> &radius, const ByRadius &order,
                               const std::vector<float> &slope, Workers &workers) {
  std::vector<float> thick(v.open.size(), 0);
  Painter painter(v, radius, thick);
  const std::size_t slabs = std::min<std::size_t>(v.shape[0], 2 * workers.threads());
  workers.loop(slabs, 1, [&](std::size_t s, unsigned) {
    painter.slab(static_cast<long>(s * v.shape[0] / slabs), static_cast<long>((s + 1) * v.shape[0] / slabs),
                 order, slope);
  });
  return thick;
}

// Lengths of open runs along one axis. On a periodic one a run goes on over the face of the box, and lines
// that are open all along have no chord; on others runs that reach a face have none.
void add_chords(const OpenVoxels &v, std::size_t axis, std::vector<double> &out) {
  const std::array<std::size_t, 3> stride = {v.shape[1] * v.shape[2], v.shape[2], 1};
  const std::size_t n = v.shape[axis];
  if (n == 1) return;
  for (std::size_t i = 0; i < v.open.size(); i++) {
    const std::size_t at = i / stride[axis] % n, line = i - at * stride[axis];
    if (!v.open[i] || (at == 0 && !v.periodic[axis])) continue;
    const auto open = [&](std::size_t k) { return v.open[line + k % n * stride[axis]] != 0; };
    if (open(at + n - 1)) continue; // not where a run begins
    std::size_t length = 1;
    while ((at + length < n || v.periodic[axis]) && open(at + length))
      length++;
    if (at + length >= n && !v.periodic[axis]) continue; // cut off by the face
    out.push_back(static_cast<double>(length) * v.spacing[axis]);
  }
}

} // namespace

Distribution distribution(std::vector<double> x) {
  Distribution out;
  out.count = x.size();
  if (x.empty()) return out;
  std::sort(x.begin(), x.end());
  const auto n = static_cast<double>(x.size());
  for (const double v : x)
    out.mean += v / n;
  double squares = 0;
  for (const double v : x)
    squares += (v - out.mean) * (v - out.mean);
  if (x.size() > 1) out.sd = std::sqrt(squares / (n - 1));
  const auto quantile = [&](double share) { return x[static_cast<std::size_t>(share * (n - 1) + 0.5)]; };
  out.median = quantile(0.5), out.p95 = quantile(0.95);
  return out;
}

std::vector<float> pore_radii(const OpenVoxels &voxels, Workers &workers) {
  std::vector<float> squared(voxels.open.size());
  bool any = false;
  for (std::size_t i = 0; i < squared.size(); i++)
    squared[i] = voxels.open[i] ? none : 0, any = any || !voxels.open[i];
  if (!any) return std::vector<float>(squared.size(), 0);
  const std::array<std::size_t, 3> stride = {voxels.shape[1] * voxels.shape[2], voxels.shape[2], 1};
  for (std::size_t axis = 3; axis-- > 0;) {
    const std::size_t n = voxels.shape[axis], lines = squared.size() / n;
    if (n == 1) continue;
    workers.loop(lines, 64, [&](std::size_t line, unsigned) {
      const std::size_t inner = line % stride[axis], outer = line / stride[axis];
      const std::size_t first = outer * n * stride[axis] + inner;
      std::vector<float> values(n);
      for (std::size_t k = 0; k < n; k++)
        values[k] = squared[first + k * stride[axis]];
      LineTransform()(values, voxels.spacing[axis], voxels.periodic[axis]);
      for (std::size_t k = 0; k < n; k++)
        squared[first + k * stride[axis]] = values[k];
    });
  }
  const double half = 0.5 * voxel_of(voxels);
  for (std::size_t i = 0; i < squared.size(); i++)
    squared[i] =
        voxels.open[i] ? static_cast<float>(std::sqrt(static_cast<double>(squared[i])) - half) : 0.0f;
  return squared;
}

double median_radius(const OpenVoxels &voxels, Workers &workers) {
  const std::vector<float> radius = pore_radii(voxels, workers);
  std::vector<float> open;
  for (std::size_t i = 0; i < radius.size(); i++)
    if (voxels.open[i]) open.push_back(radius[i]);
  if (open.empty()) return 0;
  if (open.size() == radius.size()) {
    double longest = 0;
    for (std::size_t a = 0; a < 3; a++)
      longest = std::max(longest, voxels.spacing[a] * static_cast<double>(voxels.shape[a]));
    return 0.5 * longest;
  }
  const auto middle = open.begin() + static_cast<std::ptrdiff_t>(open.size() / 2);
  std::nth_element(open.begin(), middle, open.end());
  return static_cast<double>(*middle);
}

PoreSpace pore_space(const std::vector<OpenVoxels> &media, Workers &workers) {
  std::vector<double> centres, all, thick, medial, chords;
  for (const OpenVoxels &voxels : media) {
    const std::vector<float> radius = pore_radii(voxels, workers);
    const ByRadius order(voxels, radius);
    const Steps steps(voxels, Steps::around(voxels, 3), 1);
    const FaceDistance face(voxels);
    for (const std::size_t i : maxima(voxels, steps, radius, order))
      if (static_cast<double>(radius[i]) <= face(i)) centres.push_back(static_cast<double>(radius[i]));
    const std::vector<float> slope = slopes(steps, radius, order, workers),
                             thickness = thicknesses(voxels, radius, order, slope, workers);
    const double margin = order.count() ? 2 * static_cast<double>(radius[order[0]]) : 0;
    for (std::size_t k = 0; k < order.count(); k++) {
      const std::size_t i = order[k];
      if (face(i) < margin) continue;
      all.push_back(static_cast<double>(radius[i])), thick.push_back(static_cast<double>(thickness[i]));
      if (static_cast<double>(slope[k]) < medial_slope) medial.push_back(2 * static_cast<double>(radius[i]));
    }
    for (std::size_t axis = 0; axis < 3; axis++)
      add_chords(voxels, axis, chords);
  }
  return {distribution(std::move(centres)), distribution(std::move(all)), distribution(std::move(thick)),
          distribution(std::move(medial)), distribution(std::move(chords))};
}

} // namespace conceg::analyse
