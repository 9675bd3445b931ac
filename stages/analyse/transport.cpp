// SPDX-License-Identifier: BSD-3-Clause
#include "transport.hpp"

#include "multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace conceg::analyse {

namespace {

constexpr int most_iterations = 5000, usual_iterations = 60; // of the latter progress is told

// The operator on open voxels, numbered as they come, for the slope along one axis: sum over the open
// neighbours of c_a (u_i - u_j), c_a = 1 / spacing_a^2. Beyond a face that is not periodic there is nothing,
// but that along the axis itself u is 0 on the face, half a voxel away.
class CellProblem {
public:
  CellProblem(const OpenVoxels &voxels, Workers &workers) : spacing_(voxels.spacing), workers_(workers) {
    std::vector<std::uint32_t> number(voxels.open.size(), closed);
    std::vector<std::size_t> place;
    for (std::size_t i = 0; i < voxels.open.size(); i++)
      if (voxels.open[i]) number[i] = static_cast<std::uint32_t>(place.size()), place.push_back(i);
    const Steps steps(voxels, {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}, 1);
    const auto thin = [&](std::size_t a) { return voxels.shape[a] == 1; };
    near_.resize(place.size());
    workers.loop(place.size(), chunk, [&](std::size_t n, unsigned) {
      for (std::size_t k = 0; k < 6; k++) {
        // Along an axis of one voxel offsets are of no use.
        const std::size_t j = thin(k / 2) ? steps.over_faces(place[n], steps.step(k)) : steps.to(place[n], k);
        near_[n][k] = j == Steps::outside ? beyond : number[j];
      }
    });
    multigrid_.emplace(graph(), places(voxels, place), workers);
  }

  void set_axis(std::size_t axis) {
    axis_ = axis;
    std::vector<double> boundary(size(), 0);
    for (std::size_t i = 0; i < size(); i++)
      for (const std::size_t k : {2 * axis, 2 * axis + 1})
        if (near_[i][k] == beyond) boundary[i] += 2 * weight(axis);
    multigrid_->set_boundary(std::move(boundary));
  }
  std::size_t size() const { return near_.size(); }
  Multigrid &operators() { return *multigrid_; }

  // What the slope along the axis puts into each voxel: (open above - open below) / spacing.
  std::vector<double> source() const {
    std::vector<double> out(size());
    const auto open = [&](std::uint32_t j) { return j == closed ? 0 : 1; };
    workers_.loop(size(), chunk, [&](std::size_t i, unsigned) {
      out[i] = (open(near_[i][2 * axis_ + 1]) - open(near_[i][2 * axis_])) / spacing_[axis_];
    });
    return out;
  }

  // Mean of the flux along the axis over the open voxels. A voxel stands for the way to its upper neighbour;
  // at a face that is not periodic for half a voxel.
  double mean_flux(const std::vector<double> &u) const {
    const double flux = each([&](std::size_t i) {
      const std::uint32_t up = near_[i][2 * axis_ + 1];
      const double slope = u[i] / spacing_[axis_];
      double part = near_[i][2 * axis_] == beyond ? 0.5 * (1 + 2 * slope) : 0;
      if (up == beyond)
        part += 0.5 * (1 - 2 * slope);
      else if (up != closed)
        part += 1 + u[up] / spacing_[axis_] - slope;
      return part;
    });
    return size() ? flux / static_cast<double>(size()) : 0;
  }

  // body(i) for all voxels, summed: by chunks, which are added in their order.
  template <class Body> double each(const Body &body) const {
    std::vector<double> parts((size() + chunk - 1) / chunk);
    workers_.loop(parts.size(), 4, [&](std::size_t c, unsigned) {
      double part = 0;
      for (std::size_t i = c * chunk; i < std::min(size(), (c + 1) * chunk); i++)
        part += body(i);
      parts[c] = part;
    });
    return std::accumulate(parts.begin(), parts.end(), 0.0);
  }

private:
  static constexpr std::size_t chunk = 8192;
  static constexpr std::uint32_t closed = std::numeric_limits<std::uint32_t>::max(), beyond = closed - 1;

  double weight(std::size_t axis) const { return 1 / (spacing_[axis] * spacing_[axis]); }

  WeightedGraph graph() const {
    WeightedGraph out;
    out.offset.push_back(0);
    for (const std::array<std::uint32_t, 6> &near : near_) {
      for (std::size_t k = 0; k < 6; k++)
        if (near[k] < beyond) {
          out.neighbour.push_back(near[k]);
          out.weight.push_back(static_cast<float>(weight(k / 2)));
        }
      out.offset.push_back(out.neighbour.size());
    }
    return out;
  }

  static std::vector<Multigrid::Place> places(const OpenVoxels &voxels,
                                              const std::vector<std::size_t> &place) {
    const auto [nx, ny, nz] = voxels.shape;
    (void)nx;
    std::vector<Multigrid::Place> out;
    out.reserve(place.size());
    for (const std::size_t i : place)
      out.push_back({static_cast<std::uint32_t>(i / nz / ny), static_cast<std::uint32_t>(i / nz % ny),
                     static_cast<std::uint32_t>(i % nz)});
    return out;
  }

  std::array<double, 3> spacing_;
  Workers &workers_;
  std::size_t axis_ = 0;
  std::vector<std::array<std::uint32_t, 6>> near_; // number of the open neighbour, or closed, or beyond
  std::optional<Multigrid> multigrid_;
};

// Preconditioned conjugate gradients; isolated pieces of the open space only add constants, which do no harm.
int solve(CellProblem &problem, const std::vector<double> &source, double tolerance, std::vector<double> &u,
          const Progress &progress) {
  std::vector<double> residual = source, direction(u.size(), 0), near(u.size(), 0), applied(u.size(), 0);
  double squares = problem.each([&](std::size_t i) { return residual[i] * residual[i]; }), product = 1;
  const double enough = tolerance * tolerance * squares;
  int n = 0;
  for (; n < most_iterations && squares > enough; n++) {
    report(progress, "transport", static_cast<std::uint64_t>(std::min(n, usual_iterations)), usual_iterations);
    problem.operators().precondition(residual, near);
    const double next = problem.each([&](std::size_t i) { return residual[i] * near[i]; });
    const double share = n ? next / product : 0;
    product = next;
    problem.each([&](std::size_t i) { return direction[i] = near[i] + share * direction[i], 0.0; });
    problem.operators().apply(direction, applied);
    const double curvature = problem.each([&](std::size_t i) { return direction[i] * applied[i]; });
    if (!(curvature > 0)) break;
    const double step = product / curvature;
    squares = problem.each([&](std::size_t i) {
      u[i] += step * direction[i], residual[i] -= step * applied[i];
      return residual[i] * residual[i];
    });
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
  CellProblem problem(voxels, workers);
  for (std::size_t a = 0; a < 3; a++) {
    if (!axes[a]) continue;
    problem.set_axis(a);
    std::vector<double> u(problem.size(), 0);
    out.iterations[a] = solve(problem, problem.source(), tolerance, u, progress);
    out.ratio[a] = problem.mean_flux(u);
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
