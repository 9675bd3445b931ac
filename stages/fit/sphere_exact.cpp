// SPDX-License-Identifier: BSD-3-Clause
#include "sphere_exact.hpp"

#include "bessel.hpp"
#include "conceg/portable.h"

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <unsupported/Eigen/MatrixFunctions>

#include <algorithm>
#include <cmath>

namespace conceg::fit {
namespace {

// Integral of z between two normalised modes of neighbouring orders (Grebenkov 2007, table of the sphere).
double element(unsigned l, double mu, unsigned k, double nu) {
  const auto norm = [](unsigned order, double root) {
    return root == 0.0 ? std::sqrt(1.5)
                       : std::sqrt((2 * order + 1) * root * root / (root * root - order * (order + 1.0)));
  };
  const double a = mu * mu, b = nu * nu;
  return (l + k + 1.0) / ((2 * l + 1.0) * (2 * k + 1.0)) * norm(l, mu) * norm(k, nu) *
         (a + b - l * (k + 1.0) - k * (l + 1.0) + 1.0) / ((a - b) * (a - b));
}

using Sparse = Eigen::SparseMatrix<double>;

// exp(-A time) e_0 in the Krylov space of (1 + shift A)^-1 (van den Eshof & Hochbruck 2006): its size does
// not grow with the fast modes of A. 30 vectors leave 1e-11.
Eigen::VectorXd pulse(const Sparse &a, double time) {
  const Eigen::Index n = a.rows(), most = std::min<Eigen::Index>(n, 30);
  const double shift = 0.1 * time;
  Sparse shifted(n, n);
  shifted.setIdentity();
  shifted += shift * a;
  // Neighbouring orders alone are coupled, so that modes by order make a narrow band.
  Eigen::SparseLU<Sparse, Eigen::NaturalOrdering<int>> solver(shifted);
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(n, most + 1), h = Eigen::MatrixXd::Zero(most + 1, most);
  basis(0, 0) = 1.0;
  Eigen::Index size = 0;
  while (size < most) {
    Eigen::VectorXd w = solver.solve(basis.col(size));
    for (int pass = 0; pass < 2; pass++) { // twice is enough
      const Eigen::VectorXd along = basis.leftCols(size + 1).transpose() * w;
      w -= basis.leftCols(size + 1) * along;
      h.col(size).head(size + 1) += along;
    }
    const double rest = w.norm();
    h(size + 1, size) = rest;
    size++;
    if (rest < 1e-14) break;
    basis.col(size) = w / rest;
  }
  const Eigen::MatrixXd inverse = h.topLeftCorner(size, size).inverse();
  const Eigen::MatrixXd exponent = -(time / shift) * (inverse - Eigen::MatrixXd::Identity(size, size));
  const Eigen::MatrixXd small = exponent.exp();
  return basis.leftCols(size) * small.col(0);
}

} // namespace

SphereModes::SphereModes(double below) {
  for (unsigned l = 0;; l++) {
    std::vector<double> roots = derivative_roots(l, below);
    if (l == 0) roots.insert(roots.begin(), 0.0); // the uniform mode comes first
    if (roots.empty()) break;
    for (const double root : roots)
      mu.push_back(root), order.push_back(l);
  }
  const std::size_t n = mu.size();
  z.assign(n * n, 0.0);
  for (std::size_t j = 0; j < n; j++)
    for (std::size_t k = 0; k < n; k++)
      if (order[j] + 1 == order[k] || order[k] + 1 == order[j])
        z[j * n + k] = element(order[j], mu[j], order[k], mu[k]);
}

double sphere_exact(const SphereModes &modes, const Timing &timing, double b, double radius_um,
                    double diffusivity) {
  if (!(b > 0.0)) return 1.0;
  const std::size_t n = modes.mu.size();
  const double q = std::sqrt(timing.squared_gradient(b)) * radius_um;
  std::vector<double> rate(n);
  std::vector<Eigen::Triplet<double, int>> entries;
  for (std::size_t j = 0; j < n; j++) {
    rate[j] = diffusivity * modes.mu[j] * modes.mu[j] / (radius_um * radius_um);
    entries.emplace_back(static_cast<int>(j), static_cast<int>(j), rate[j]);
    for (std::size_t k = 0; k < n; k++)
      if (modes.z[j * n + k] != 0.0)
        entries.emplace_back(static_cast<int>(j), static_cast<int>(k),
                             (modes.order[j] > modes.order[k] ? q : -q) * modes.z[j * n + k]);
  }
  Sparse a(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd w = pulse(a, timing.delta_ms);
  double signal = 0.0;
  for (std::size_t k = 0; k < n; k++) {
    const double amplitude = w(static_cast<Eigen::Index>(k));
    signal += amplitude * amplitude * conceg_exp(-rate[k] * (timing.separation_ms - timing.delta_ms));
  }
  return signal;
}

} // namespace conceg::fit
