// SPDX-License-Identifier: BSD-3-Clause
#include "transport.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace conceg::analyse {

namespace {

constexpr int most_iterations = 5000;

// The operator on open voxels for the slope along one axis: sum over the open neighbours of c_a (u_i - u_j),
// c_a = 1 / spacing_a^2. Beyond a face that is not periodic there is nothing, but that along the axis itself u
// is 0 on the face, half a voxel away.
class CellProblem {
public:
  CellProblem(const OpenVoxels &voxels, std::size_t axis, Workers &workers)
      : voxels_(voxels), axis_(axis), workers_(workers) {
    for (std::size_t a = 0; a < 3; a++)
      weight_[a] = 1 / (voxels.spacing[a] * voxels.spacing[a]);
  }

  std::size_t size() const { return voxels_.open.size(); }

  // Calls visit(i, on every axis: lower and upper neighbour, or `beyond`) for the open voxels of one plane.
  template <class Visit> void plane(std::size_t x, const Visit &visit) const {
    const auto [nx, ny, nz] = voxels_.shape;
    const auto low = [&](std::size_t a, std::size_t at) {
      return at ? at - 1 : voxels_.periodic[a] ? voxels_.shape[a] - 1 : beyond;
    };
    const auto high = [&](std::size_t a, std::size_t at) {
      return at + 1 < voxels_.shape[a] ? at + 1 : voxels_.periodic[a] ? 0 : beyond;
    };
    const auto at = [ny = ny, nz = nz](std::size_t i, std::size_t j, std::size_t k) {
      return i == beyond || j == beyond || k == beyond ? beyond : (i * ny + j) * nz + k;
    };
    const std::size_t x_low = low(0, x), x_high = high(0, x);
    for (std::size_t y = 0; y < ny; y++) {
      const std::size_t y_low = low(1, y), y_high = high(1, y), row = (x * ny + y) * nz;
      for (std::size_t z = 0; z < nz; z++)
        if (voxels_.open[row + z])
          visit(row + z, std::array<std::size_t, 6>{at(x_low, y, z), at(x_high, y, z), at(x, y_low, z),
                                                    at(x, y_high, z), at(x, y, low(2, z)),
                                                    at(x, y, high(2, z))});
    }
  }

  // out = A u; returns u . A u.
  double apply(const std::vector<double> &u, std::vector<double> &out) const {
    return sum([&](std::size_t x) {
      double product = 0;
      plane(x, [&](std::size_t i, const std::array<std::size_t, 6> &near) {
        double flux = 0;
        for (std::size_t k = 0; k < 6; k++)
          if (near[k] == beyond)
            flux += k / 2 == axis_ ? 2 * weight_[axis_] * u[i] : 0;
          else if (voxels_.open[near[k]])
            flux += weight_[k / 2] * (u[i] - u[near[k]]);
        out[i] = flux, product += u[i] * flux;
      });
      return product;
    });
  }

  // What the slope along the axis puts into each voxel: (open above - open below) / spacing.
  std::vector<double> source() const {
    std::vector<double> out(size(), 0);
    workers_.loop(voxels_.shape[0], 1, [&](std::size_t x, unsigned) {
      plane(x, [&](std::size_t i, const std::array<std::size_t, 6> &near) {
        const auto open = [&](std::size_t j) { return j == beyond ? 1 : voxels_.open[j]; };
        out[i] = (open(near[2 * axis_ + 1]) - open(near[2 * axis_])) / voxels_.spacing[axis_];
      });
    });
    return out;
  }

  // Mean of the flux along the axis over the open voxels. A voxel stands for the way to its upper neighbour;
  // at a face that is not periodic for half a voxel.
  double mean_flux(const std::vector<double> &u) const {
    double open = 0;
    const double flux = sum([&](std::size_t x) {
      double part = 0;
      plane(x, [&](std::size_t i, const std::array<std::size_t, 6> &near) {
        const std::size_t up = near[2 * axis_ + 1];
        const double slope = u[i] / voxels_.spacing[axis_];
        if (near[2 * axis_] == beyond) part += 0.5 * (1 + 2 * slope);
        if (up == beyond)
          part += 0.5 * (1 - 2 * slope);
        else if (voxels_.open[up])
          part += 1 + u[up] / voxels_.spacing[axis_] - slope;
      });
      return part;
    });
    for (const std::uint8_t v : voxels_.open)
      open += v;
    return open > 0 ? flux / open : 0;
  }

  // Sum over planes, added in their order.
  template <class OfPlane> double sum(const OfPlane &of_plane) const {
    std::vector<double> parts(voxels_.shape[0]);
    workers_.loop(parts.size(), 1, [&](std::size_t x, unsigned) { parts[x] = of_plane(x); });
    return std::accumulate(parts.begin(), parts.end(), 0.0);
  }

  // body(i) for all voxels, summed.
  template <class Body> double each(const Body &body) const {
    const std::size_t plane_size = voxels_.shape[1] * voxels_.shape[2];
    return sum([&](std::size_t x) {
      double part = 0;
      for (std::size_t i = x * plane_size; i < (x + 1) * plane_size; i++)
        part += body(i);
      return part;
    });
  }

private:
  static constexpr std::size_t beyond = std::numeric_limits<std::size_t>::max();
  const OpenVoxels &voxels_;
  const std::size_t axis_;
  Workers &workers_;
  std::array<double, 3> weight_;
};

// Conjugate gradients; isolated pieces of the open space only add constants, which do no harm.
int solve(const CellProblem &problem, const std::vector<double> &source, double tolerance,
          std::vector<double> &u, const Progress &progress) {
  std::vector<double> residual = source, direction = source, applied(u.size(), 0);
  double squares = problem.each([&](std::size_t i) { return residual[i] * residual[i]; });
  const double enough = tolerance * tolerance * squares;
  int n = 0;
  for (; n < most_iterations && squares > enough; n++) {
    if (n % 20 == 0) report(progress, "transport", static_cast<std::uint64_t>(n), most_iterations);
    const double curvature = problem.apply(direction, applied);
    if (!(curvature > 0)) break;
    const double step = squares / curvature;
    const double next = problem.each([&](std::size_t i) {
      u[i] += step * direction[i], residual[i] -= step * applied[i];
      return residual[i] * residual[i];
    });
    const double share = next / squares;
    problem.each([&](std::size_t i) { return direction[i] = residual[i] + share * direction[i], 0.0; });
    squares = next;
  }
  return n;
}

} // namespace

double Transport::lambda() const {
  const double mean = (ratio[0] + ratio[1] + ratio[2]) / 3;
  return mean > 0 ? 1 / std::sqrt(mean) : std::numeric_limits<double>::infinity();
}

Transport transport_of(const OpenVoxels &voxels, const std::array<bool, 3> &axes, double tolerance,
                       Workers &workers, const Progress &progress) {
  Transport out;
  out.open_fraction = open_fraction(voxels);
  for (std::size_t a = 0; a < 3; a++) {
    if (!axes[a]) continue;
    const CellProblem problem(voxels, a, workers);
    std::vector<double> u(problem.size(), 0);
    out.iterations[a] = solve(problem, problem.source(), tolerance, u, progress);
    out.ratio[a] = problem.mean_flux(u);
  }
  return out;
}

} // namespace conceg::analyse
