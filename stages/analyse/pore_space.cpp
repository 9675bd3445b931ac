// SPDX-License-Identifier: BSD-3-Clause
#include "pore_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace conceg::analyse {

namespace {

constexpr float none = std::numeric_limits<float>::infinity();
constexpr double prominence = 0.5;    // of a voxel: lower maxima are noise of the grid
constexpr double medial_slope = 0.70; // of the radius; on the medial surface no neighbour's is steeper

double voxel_of(const OpenVoxels &v) {
  return std::cbrt(v.spacing[0] * v.spacing[1] * v.spacing[2]);
}

// Squared distances along one periodic line: lower envelope of the parabolas of all points and of their
// images on both sides (Felzenszwalb and Huttenlocher 2012).
class LineTransform {
public:
  void operator()(std::vector<float> &f, double step) {
    const auto n = static_cast<long>(f.size());
    apex_.clear(), from_.clear();
    const auto value = [&](long i) {
      return static_cast<double>(f[static_cast<std::size_t>(((i % n) + n) % n)]);
    };
    for (long i = -n; i < 2 * n; i++) {
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

// Neighbours of voxel i over the faces of the box, diagonal ones included; visit(neighbour, distance).
template <class Visit> void neighbours(const OpenVoxels &v, std::size_t i, const Visit &visit) {
  const auto [nx, ny, nz] = v.shape;
  const std::size_t x = i / (ny * nz), y = i / nz % ny, z = i % nz;
  for (std::size_t dx = 0; dx < 3; dx++)
    for (std::size_t dy = 0; dy < 3; dy++)
      for (std::size_t dz = 0; dz < 3; dz++) {
        const std::size_t j =
            ((x + nx + dx - 1) % nx * ny + (y + ny + dy - 1) % ny) * nz + (z + nz + dz - 1) % nz;
        if (j == i) continue;
        const double a = (static_cast<double>(dx) - 1) * v.spacing[0],
                     b = (static_cast<double>(dy) - 1) * v.spacing[1],
                     c = (static_cast<double>(dz) - 1) * v.spacing[2];
        visit(j, std::sqrt(a * a + b * b + c * c));
      }
}

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

std::vector<std::size_t> by_radius(const OpenVoxels &v, const std::vector<float> &radius) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < v.open.size(); i++)
    if (v.open[i]) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return radius[a] != radius[b] ? radius[a] > radius[b] : a < b;
  });
  return order;
}

// Maxima that stand out: voxels are flooded from the widest on; where two floods meet the lower one ends, and
// counts when its top is that much above the meeting.
std::vector<double> maxima(const OpenVoxels &v, const std::vector<float> &radius,
                           const std::vector<std::size_t> &order) {
  const double least = prominence * voxel_of(v);
  constexpr std::size_t dry = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> top(v.open.size(), dry); // union-find; the root is the top of its flood
  const auto find = [&](std::size_t i) {
    while (top[i] != i)
      i = top[i] = top[top[i]];
    return i;
  };
  std::vector<double> out;
  for (const std::size_t i : order) {
    top[i] = i;
    neighbours(v, i, [&](std::size_t j, double) {
      if (top[j] == dry) return;
      std::size_t a = find(i), b = find(j);
      if (a == b) return;
      if (radius[a] < radius[b] || (radius[a] == radius[b] && a > b)) std::swap(a, b);
      if (b != i && static_cast<double>(radius[b]) - static_cast<double>(radius[i]) >= least)
        out.push_back(static_cast<double>(radius[b]));
      top[b] = a;
    });
  }
  for (const std::size_t i : order)
    if (top[i] == i) out.push_back(static_cast<double>(radius[i])); // the highest of each piece
  return out;
}

// Largest slope of the radius from a voxel to one of its neighbours.
double steepest(const OpenVoxels &v, const std::vector<float> &radius, std::size_t i) {
  double slope = -none;
  neighbours(v, i, [&](std::size_t j, double apart) {
    slope = std::max(slope, (static_cast<double>(radius[j]) - static_cast<double>(radius[i])) / apart);
  });
  return slope;
}

// Paints balls, the largest first; a ball within a neighbour's adds nothing.
std::vector<double> thicknesses(const OpenVoxels &v, const std::vector<float> &radius,
                                const std::vector<std::size_t> &order) {
  const auto [nx, ny, nz] = v.shape;
  std::vector<float> thick(v.open.size(), 0);
  for (const std::size_t i : order) {
    const double r = static_cast<double>(radius[i]);
    if (thick[i] == 0) thick[i] = radius[i];
    if (steepest(v, radius, i) >= 1 - 1e-6) continue;
    const std::array<std::size_t, 3> n = {nx, ny, nz}, at = {i / (ny * nz), i / nz % ny, i % nz};
    std::array<long, 3> reach = {};
    for (std::size_t a = 0; a < 3; a++)
      reach[a] = n[a] == 1 ? 0 : static_cast<long>(r / v.spacing[a]);
    const auto wrapped = [&](std::size_t a, long d) {
      const long m = static_cast<long>(n[a]);
      return static_cast<std::size_t>((static_cast<long>(at[a]) + d % m + m) % m);
    };
    for (long dx = -reach[0]; dx <= reach[0]; dx++)
      for (long dy = -reach[1]; dy <= reach[1]; dy++)
        for (long dz = -reach[2]; dz <= reach[2]; dz++) {
          const double a = static_cast<double>(dx) * v.spacing[0], b = static_cast<double>(dy) * v.spacing[1],
                       c = static_cast<double>(dz) * v.spacing[2];
          if (a * a + b * b + c * c > r * r) continue;
          const std::size_t j = (wrapped(0, dx) * ny + wrapped(1, dy)) * nz + wrapped(2, dz);
          if (v.open[j]) thick[j] = std::max(thick[j], radius[i]);
        }
  }
  std::vector<double> out;
  for (const std::size_t i : order)
    out.push_back(static_cast<double>(thick[i]));
  return out;
}

// Lengths of open runs along one axis; a run goes on over the face of the box. Lines that are open all along
// have no chord.
void add_chords(const OpenVoxels &v, std::size_t axis, std::vector<double> &out) {
  const std::array<std::size_t, 3> stride = {v.shape[1] * v.shape[2], v.shape[2], 1};
  const std::size_t n = v.shape[axis];
  if (n == 1) return;
  for (std::size_t i = 0; i < v.open.size(); i++) {
    const std::size_t at = i / stride[axis] % n, line = i - at * stride[axis];
    const auto open = [&](std::size_t k) { return v.open[line + k % n * stride[axis]] != 0; };
    if (!open(at) || open(at + n - 1)) continue; // not where a run begins
    std::size_t length = 1;
    while (open(at + length))
      length++;
    out.push_back(static_cast<double>(length) * v.spacing[axis]);
  }
}

} // namespace

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
      LineTransform()(values, voxels.spacing[axis]);
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

PoreSpace pore_space(const std::vector<OpenVoxels> &media, Workers &workers) {
  std::vector<double> centres, all, thick, medial, chords;
  const auto add = [](std::vector<double> &to, const std::vector<double> &from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const OpenVoxels &voxels : media) {
    const std::vector<float> radius = pore_radii(voxels, workers);
    const std::vector<std::size_t> order = by_radius(voxels, radius);
    add(centres, maxima(voxels, radius, order));
    add(thick, thicknesses(voxels, radius, order));
    std::vector<double> slope(order.size());
    workers.loop(order.size(), 1024,
                 [&](std::size_t k, unsigned) { slope[k] = steepest(voxels, radius, order[k]); });
    for (std::size_t k = 0; k < order.size(); k++) {
      all.push_back(static_cast<double>(radius[order[k]]));
      if (slope[k] < medial_slope) medial.push_back(2 * static_cast<double>(radius[order[k]]));
    }
    for (std::size_t axis = 0; axis < 3; axis++)
      add_chords(voxels, axis, chords);
  }
  return {distribution(std::move(centres)), distribution(std::move(all)), distribution(std::move(thick)),
          distribution(std::move(medial)), distribution(std::move(chords))};
}

OpenVoxels section(const OpenVoxels &voxels, std::size_t axis, std::size_t at) {
  OpenVoxels out = {voxels.shape, {}, voxels.spacing};
  out.shape[axis] = 1;
  const std::array<std::size_t, 3> stride = {voxels.shape[1] * voxels.shape[2], voxels.shape[2], 1};
  for (std::size_t i = 0; i < voxels.open.size(); i++)
    if (i / stride[axis] % voxels.shape[axis] == at) out.open.push_back(voxels.open[i]);
  return out;
}

} // namespace conceg::analyse
