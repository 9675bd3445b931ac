// SPDX-License-Identifier: BSD-3-Clause
#include "erosion.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::analyse {

namespace {

constexpr double deepest_voxels = 32;
constexpr std::size_t bins = 32000; // of depth
constexpr std::size_t finest = 8;   // times smaller than the labels' voxels

double voxel_of(const LabelGrid &g) {
  return std::sqrt(g.spacing[0] * g.spacing[1]);
}

// A hundredth more, so that what is cut off as too deep is in the last one in spite of rounding.
std::size_t bin_of(double depth, double bin) {
  return std::min(bins, static_cast<std::size_t>(depth / bin + 0.01));
}

// One section: labels and squared distances, y fastest.
struct Plane {
  std::size_t nx, ny;
  std::vector<std::uint32_t> label;
  std::vector<float> squared;
};

// Squared distance to the nearest other label in the same row along y.
void along_y(Plane &p, double step, float most) {
  for (std::size_t x = 0; x < p.nx; x++) {
    const std::uint32_t *label = &p.label[x * p.ny];
    for (std::size_t from = 0, to; from < p.ny; from = to) {
      for (to = from + 1; to < p.ny && label[to] == label[from];)
        to++;
      for (std::size_t y = from; y < to; y++) {
        double nearest = INFINITY;
        if (from > 0) nearest = static_cast<double>(y - from + 1);
        if (to < p.ny) nearest = std::min(nearest, static_cast<double>(to - y));
        p.squared[x * p.ny + y] = std::min(most, static_cast<float>(nearest * nearest * step * step));
      }
    }
  }
}

// The least over the column along x: only voxels nearer than what is known can give less, and beyond another
// label its own distance is less than any.
std::vector<float> along_x(const Plane &p, double step) {
  std::vector<float> out(p.squared);
  for (std::size_t x = 0; x < p.nx; x++)
    for (std::size_t y = 0; y < p.ny; y++) {
      const std::size_t i = x * p.ny + y;
      float best = p.squared[i];
      for (const long side : {-1L, 1L})
        for (long d = 1;; d++) {
          const auto away = static_cast<float>(static_cast<double>(d * d) * step * step);
          const long to = static_cast<long>(x) + side * d;
          if (!(away < best) || to < 0 || to >= static_cast<long>(p.nx)) break;
          const std::size_t j = static_cast<std::size_t>(to) * p.ny + y;
          if (p.label[j] != p.label[i]) {
            best = away;
            break;
          }
          best = std::min(best, away + p.squared[j]);
        }
      out[i] = best;
    }
  return out;
}

// Distance within a section between the centres of voxels: linear, negative in another label.
class FineSection {
public:
  FineSection(const LabelGrid &grid, const std::vector<float> &distance, std::size_t z, std::size_t refine)
      : grid_(grid), distance_(distance), z_(z), refine_(refine) {}

  // Depth of a small voxel in its label; -1 where it has none.
  double depth(std::size_t x, std::size_t y) const {
    const auto [nx, ny, nz] = grid_.shape;
    const std::uint32_t own = grid_.label[(x / refine_ * ny + y / refine_) * nz + z_];
    if (!own) return -1;
    const Between a = between(x, nx), b = between(y, ny);
    double sum = 0;
    for (std::size_t k = 0; k < 4; k++) {
      const std::size_t i = ((k / 2 ? a.upper : a.lower) * ny + (k % 2 ? b.upper : b.lower)) * nz + z_;
      const double share = (k / 2 ? a.share : 1 - a.share) * (k % 2 ? b.share : 1 - b.share);
      sum += share * static_cast<double>(distance_[i]) * (grid_.label[i] == own ? 1 : -1);
    }
    return std::max(0.0, sum);
  }

private:
  struct Between {
    std::size_t lower, upper;
    double share; // of the upper one
  };
  Between between(std::size_t fine, std::size_t count) const {
    const double at = (static_cast<double>(fine) + 0.5) / static_cast<double>(refine_) - 0.5,
                 low = std::max(0.0, std::floor(at));
    const auto lower = static_cast<std::size_t>(low);
    return {lower, std::min(count - 1, lower + 1), std::max(0.0, at - low)};
  }
  const LabelGrid &grid_;
  const std::vector<float> &distance_;
  std::size_t z_, refine_;
};

// visit(depth, x, y) of all small voxels of a section.
template <class Visit>
void each_fine(const LabelGrid &grid, const std::vector<float> &distance, std::size_t z, std::size_t refine,
               const Visit &visit) {
  const FineSection fine(grid, distance, z, refine);
  for (std::size_t x = 0; x < grid.shape[0] * refine; x++)
    for (std::size_t y = 0; y < grid.shape[1] * refine; y++)
      visit(fine.depth(x, y), x, y);
}

// The depth at which the planes are as open as asked.
struct Depth {
  std::size_t bin; // depth = bin / bins of the deepest
  double open_fraction, without_label;
};

Depth depth_for(double asked, const LabelGrid &grid, const std::vector<float> &distance,
                const std::vector<std::size_t> &plane, std::size_t refine, double bin, Workers &workers) {
  std::vector<std::vector<std::uint64_t>> parts(plane.size());
  workers.loop(plane.size(), 1, [&](std::size_t s, unsigned) {
    std::vector<std::uint64_t> &count = parts[s];
    count.assign(bins + 2, 0); // the first: without label
    each_fine(grid, distance, plane[s], refine, [&](double depth, std::size_t, std::size_t) {
      count[depth < 0 ? 0 : 1 + bin_of(depth, bin)]++;
    });
  });
  std::vector<std::uint64_t> count(bins + 2, 0);
  for (const std::vector<std::uint64_t> &part : parts)
    for (std::size_t k = 0; k < count.size(); k++)
      count[k] += part[k];
  const double all = static_cast<double>(grid.shape[0] * grid.shape[1] * plane.size() * refine * refine),
               wanted = asked * all;
  double open = static_cast<double>(count[0]);
  if (open > wanted)
    fail(CONCEG_E_RANGE, "erode_to: %g asked for, but %.4f have no label", asked, open / all);
  std::size_t k = 0; // to the bin that comes nearest
  while (k < bins && std::abs(open + static_cast<double>(count[1 + k]) - wanted) <= std::abs(open - wanted))
    open += static_cast<double>(count[1 + k++]);
  if (k == bins)
    fail(CONCEG_E_RANGE, "erode_to: %g needs more than %g um off the membranes, which is as far as is looked",
         asked, static_cast<double>(bins) * bin);
  return {k, open / all, static_cast<double>(count[0]) / all};
}

} // namespace

std::vector<float> membrane_distances(const LabelGrid &grid, double deepest_um, Workers &workers) {
  const auto [nx, ny, nz] = grid.shape;
  const double half = 0.5 * voxel_of(grid);
  const auto most = static_cast<float>((deepest_um + half) * (deepest_um + half));
  std::vector<float> out(grid.label.size());
  workers.loop(nz, 1, [&, nx = nx, ny = ny, nz = nz](std::size_t z, unsigned) {
    Plane plane = {nx, ny, std::vector<std::uint32_t>(nx * ny), std::vector<float>(nx * ny)};
    for (std::size_t i = 0; i < nx * ny; i++)
      plane.label[i] = grid.label[i * nz + z];
    along_y(plane, grid.spacing[1], most);
    const std::vector<float> squared = along_x(plane, grid.spacing[0]);
    for (std::size_t i = 0; i < nx * ny; i++)
      out[i * nz + z] = static_cast<float>(std::sqrt(static_cast<double>(squared[i])) - half);
  });
  return out;
}

Erosion erode(LabelGrid &grid, const ErosionSettings &settings, Workers &workers) {
  const auto [nx, ny, nz] = grid.shape;
  const double deepest = deepest_voxels * voxel_of(grid), bin = deepest / bins;
  const std::vector<float> distance = membrane_distances(grid, deepest, workers);
  std::vector<std::size_t> plane;
  for (std::size_t z = std::min(nz - 1, settings.between / 2); z < nz; z += settings.between)
    plane.push_back(z);
  // A cleft of twice the depth is to be four voxels wide.
  std::size_t refine = settings.refine;
  Depth found = {};
  for (;; refine *= 2) {
    found = depth_for(settings.open_fraction, grid, distance, plane, refine, bin, workers);
    if (voxel_of(grid) / static_cast<double>(refine) <= 0.5 * static_cast<double>(found.bin) * bin ||
        2 * refine > finest)
      break;
  }
  Erosion out;
  out.depth = static_cast<double>(found.bin) * bin;
  out.open_fraction = found.open_fraction, out.without_label = found.without_label;
  out.sections.resize(plane.size());
  workers.loop(plane.size(), 1, [&, nx = nx, ny = ny](std::size_t s, unsigned) {
    OpenVoxels &section = out.sections[s];
    const auto fine = static_cast<double>(refine);
    section.shape = {nx * refine, ny * refine, 1};
    section.spacing = {grid.spacing[0] / fine, grid.spacing[1] / fine, grid.spacing[2]};
    section.periodic = {false, false, false};
    section.open.reserve(section.shape[0] * section.shape[1]);
    each_fine(grid, distance, plane[s], refine, [&](double depth, std::size_t, std::size_t) {
      section.open.push_back(depth < 0 || bin_of(depth, bin) < found.bin);
    });
  });
  std::uint64_t left = 0;
  for (std::size_t i = 0; i < grid.label.size(); i++) {
    if (static_cast<double>(distance[i]) < out.depth) grid.label[i] = 0;
    left += grid.label[i] != 0;
  }
  out.labels_open_fraction = 1 - static_cast<double>(left) / static_cast<double>(grid.label.size());
  return out;
}

} // namespace conceg::analyse
