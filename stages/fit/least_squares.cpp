// SPDX-License-Identifier: BSD-3-Clause
// The only file that includes Ceres.
#include "least_squares.hpp"

#include <ceres/ceres.h>
#include <Eigen/Dense>

#include <algorithm>

namespace conceg::fit {
namespace {

// Ceres sees the fitted parameters alone.
std::vector<std::size_t> fitted(const LeastSquares &problem) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < problem.lower.size(); i++)
    if (problem.lower[i] < problem.upper[i]) out.push_back(i);
  return out;
}

class Cost : public ceres::CostFunction {
public:
  Cost(const LeastSquares &problem, const std::vector<double> &start)
      : problem_(problem), all_(start), fitted_(fitted(problem)) {
    set_num_residuals(static_cast<int>(problem.residuals));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(fitted_.size()));
  }
  bool Evaluate(double const *const *parameters, double *residuals, double **jacobians) const override {
    std::vector<double> values = all_;
    for (std::size_t k = 0; k < fitted_.size(); k++)
      values[fitted_[k]] = parameters[0][k];
    const bool wanted = jacobians && jacobians[0];
    std::vector<double> jacobian(wanted ? problem_.residuals * values.size() : 0);
    problem_.evaluate(values.data(), residuals, wanted ? jacobian.data() : nullptr);
    for (std::size_t row = 0; wanted && row < problem_.residuals; row++)
      for (std::size_t k = 0; k < fitted_.size(); k++)
        jacobians[0][row * fitted_.size() + k] = jacobian[row * values.size() + fitted_[k]];
    return true;
  }

private:
  const LeastSquares &problem_;
  std::vector<double> all_;
  std::vector<std::size_t> fitted_;
};

} // namespace

Minimum minimise(const LeastSquares &problem, const std::vector<double> &start) {
  const std::vector<std::size_t> chosen = fitted(problem);
  std::vector<double> values(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); k++)
    values[k] = start[chosen[k]];
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(new Cost(problem, start), nullptr, values.data());
  for (std::size_t k = 0; k < chosen.size(); k++) {
    ceres_problem.SetParameterLowerBound(values.data(), static_cast<int>(k), problem.lower[chosen[k]]);
    ceres_problem.SetParameterUpperBound(values.data(), static_cast<int>(k), problem.upper[chosen[k]]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-14;
  options.gradient_tolerance = 1e-15;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  Minimum out{start, 2.0 * summary.final_cost, summary.termination_type == ceres::CONVERGENCE};
  for (std::size_t k = 0; k < chosen.size(); k++)
    out.parameters[chosen[k]] = values[k];
  return out;
}

std::vector<double> covariance(const LeastSquares &problem, const std::vector<double> &at,
                               const std::vector<bool> &marked, const std::vector<double> &variance) {
  const std::size_t n = at.size();
  std::vector<double> residuals(problem.residuals), jacobian(problem.residuals * n), out(n * n, 0.0);
  problem.evaluate(at.data(), residuals.data(), jacobian.data());
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < n; i++)
    if (marked[i]) chosen.push_back(i);
  if (chosen.empty()) return out;
  Eigen::MatrixXd j(problem.residuals, chosen.size());
  for (std::size_t row = 0; row < problem.residuals; row++)
    for (std::size_t k = 0; k < chosen.size(); k++)
      j(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) = jacobian[row * n + chosen[k]];
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(j, Eigen::ComputeThinU | Eigen::ComputeThinV);
  if (svd.rank() < static_cast<Eigen::Index>(chosen.size())) return {};
  const Eigen::MatrixXd inverse =
      svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal() * svd.matrixU().transpose();
  const Eigen::Map<const Eigen::VectorXd> spread(variance.data(), static_cast<Eigen::Index>(variance.size()));
  const Eigen::MatrixXd c = inverse * spread.asDiagonal() * inverse.transpose();
  for (std::size_t a = 0; a < chosen.size(); a++)
    for (std::size_t b = 0; b < chosen.size(); b++)
      out[chosen[a] * n + chosen[b]] = c(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  return out;
}

} // namespace conceg::fit
