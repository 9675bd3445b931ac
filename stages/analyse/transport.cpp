// SPDX-License-Identifier: BSD-3-Clause
#include "transport.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace conceg::analyse {

namespace {

constexpr int most_iterations = 5000;

// The operator on open voxels: sum over the open neighbours of c_a (u_i - u_j), c_a = 1 / spacing_a^2.
class CellProblem {
public:
  CellProblem(const OpenVoxels &voxels, Workers &workers) : voxels_(voxels), workers_(workers) {
    for (std::size_t a = 0; a < 3; a++)
      weight_[a] = 1 / (voxels.spacing[a] * voxels.spacing[a]);
  }

  std::size_t size() const { return voxels_.open.size(); }

  // Calls visit(i, on every axis: lower and upper neighbour) for the open voxels of one plane.
  template <class Visit> void plane(std::size_t x, const Visit &visit) const {
    const auto [nx, ny, nz] = voxels_.shape;
    const std::size_t x_low = (x + nx - 1) % nx, x_high = (x + 1) % nx;
    for (std::size_t y = 0; y < ny; y++) {
      const std::size_t y_low = (y + ny - 1) % ny, y_high = (y + 1) % ny;
      const std::size_t row = (x * ny + y) * nz;
      for (std::size_t z = 0; z < nz; z++) {
        if (!voxels_.open[row + z]) continue;
        visit(row + z, std::array<std::size_t, 6>{(x_low * ny + y) * nz + z, (x_high * ny + y) * nz + z,
                                                  (x * ny + y_low) * nz + z, (x * ny + y_high) * nz + z,
                                                  row + (z + nz - 1) % nz, row + (z + 1) % nz});
      }
    }
  }

  // out = A u; returns u . A u.
  double apply(const std::vector<double> &u, std::vector<double> &out) const {
    return sum([&](std::size_t x) {
      double product = 0;
      plane(x, [&](std::size_t i, const std::array<std::size_t, 6> &near) {
        double flux = 0;
        for (std::size_t k = 0; k < 6; k++)
          if (voxels_.open[near[k]]) flux += weight_[k / 2] * (u[i] - u[near[k]]);
        out[i] = flux, product += u[i] * flux;
      });
      return product;
    });
  }

  // What the slope along an axis puts into each voxel: (open above - open below) / spacing.
  std::vector<double> source(std::size_t axis) const {
    std::vector<double> out(size(), 0);
    workers_.loop(voxels_.shape[0], 1, [&](std::size_t x, unsigned) {
      plane(x, [&](std::size_t i, const std::array<std::size_t, 6> &near) {
        out[i] = (voxels_.open[near[2 * axis + 1]] - voxels_.open[near[2 * axis]]) / voxels_.spacing[axis];
      });
    });
    return out;
  }

  // Mean of the flux along an axis over the open voxels.
  double mean_flux(const std::vector<double> &u, std::size_t axis) const {
    double open = 0;
    const double flux = sum([&](std::size_t x) {
      double part = 0;
      plane(x, [&](std::size_t i, const std::array<std::size_t, 6> &near) {
        const std::size_t up = near[2 * axis + 1];
        if (voxels_.open[up]) part += 1 + (u[up] - u[i]) / voxels_.spacing[axis];
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
  const OpenVoxels &voxels_;
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
  const CellProblem problem(voxels, workers);
  Transport out;
  out.open_fraction = problem.each([&](std::size_t i) { return static_cast<double>(voxels.open[i]); }) /
                      static_cast<double>(std::max<std::size_t>(1, problem.size()));
  for (std::size_t a = 0; a < 3; a++) {
    if (!axes[a]) continue;
    std::vector<double> u(problem.size(), 0);
    out.iterations[a] = solve(problem, problem.source(a), tolerance, u, progress);
    out.ratio[a] = problem.mean_flux(u, a);
  }
  return out;
}

OpenVoxels coarser(const OpenVoxels &voxels) {
  OpenVoxels out;
  const auto [nx, ny, nz] = voxels.shape;
  out.shape = {nx / 2, ny / 2, nz / 2};
  for (std::size_t a = 0; a < 3; a++)
    out.spacing[a] = 2 * voxels.spacing[a];
  for (std::size_t x = 0; x < nx / 2; x++)
    for (std::size_t y = 0; y < ny / 2; y++)
      for (std::size_t z = 0; z < nz / 2; z++) {
        int open = 0;
        for (std::size_t n = 0; n < 8; n++)
          open += voxels.open[((2 * x + n / 4) * ny + 2 * y + n / 2 % 2) * nz + 2 * z + n % 2];
        const std::uint8_t lowest = voxels.open[(2 * x * ny + 2 * y) * nz + 2 * z];
        out.open.push_back(open == 4 ? lowest : open > 4);
      }
  return out;
}

Transport extrapolated(const Transport &coarse, const Transport &fine) {
  Transport limit = fine;
  for (std::size_t a = 0; a < 3; a++)
    limit.ratio[a] = 2 * fine.ratio[a] - coarse.ratio[a];
  return limit;
}

} // namespace conceg::analyse
