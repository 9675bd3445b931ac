// SPDX-License-Identifier: BSD-3-Clause
#include "diffusion_tail.hpp"

#include "conceg/portable.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace conceg::analyse {

namespace {

constexpr double least_exponent = 0.05, most_exponent = 3.0;
constexpr double most_exponent_error = 0.5;
constexpr std::size_t walkers_a_time = 10; // fewer tell too little of the covariance
// Of chi2 with two degrees of freedom less: 1 in 1000 by chance.
constexpr double time_dependence = 13.8;

double power(double time, double exponent) {
  return conceg_exp(-exponent * conceg_log(time));
}

double component(const glm::dvec3 &x, int axis) {
  return axis == mean_axis ? glm::dot(x, x) / 3.0 : x[axis] * x[axis];
}

// Limit and amplitude of one exponent, whitened by the Cholesky factor of the covariance.
class Fit {
public:
  explicit Fit(const DiffusivityCurve &curve) : curve_(curve) {
    const auto n = static_cast<Eigen::Index>(curve.time.size());
    const Eigen::MatrixXd covariance = Eigen::Map<const Eigen::MatrixXd>(curve.covariance.data(), n, n);
    factor_.compute(covariance);
    value_ = whitened(Eigen::Map<const Eigen::VectorXd>(curve.value.data(), n));
    one_ = whitened(Eigen::VectorXd::Ones(n));
  }
  bool is_definite() const { return factor_.info() == Eigen::Success; }
  double chi2_of_constant() const {
    const double mean = one_.dot(value_) / one_.squaredNorm();
    return (value_ - mean * one_).squaredNorm();
  }
  double chi2(double exponent) const {
    const Eigen::MatrixXd design = design_of(exponent);
    return (value_ - design * solved(design)).squaredNorm();
  }
  // With the errors of `parameters` 2 (exponent held) or 3.
  Tail tail(double exponent, Eigen::Index parameters) const {
    const Eigen::MatrixXd design = design_of(exponent);
    const Eigen::VectorXd best = solved(design);
    Eigen::MatrixXd jacobian(design.rows(), parameters);
    jacobian.leftCols(2) = design;
    if (parameters == 3) {
      Eigen::VectorXd slope(design.rows());
      for (Eigen::Index i = 0; i < slope.size(); i++) {
        const double t = curve_.time[static_cast<std::size_t>(i)];
        slope[i] = -best[1] * conceg_log(t) * power(t, exponent);
      }
      jacobian.col(2) = whitened(slope);
    }
    const Eigen::MatrixXd covariance = (jacobian.transpose() * jacobian).inverse();
    Tail out;
    out.limit = {best[0], std::sqrt(covariance(0, 0))};
    out.amplitude = {best[1], std::sqrt(covariance(1, 1))};
    out.exponent = {exponent, parameters == 3 ? std::sqrt(covariance(2, 2)) : 0.0};
    out.chi2 = (value_ - design * best).squaredNorm();
    out.degrees = curve_.time.size() - static_cast<std::size_t>(parameters);
    return out;
  }

private:
  Eigen::VectorXd whitened(const Eigen::VectorXd &v) const { return factor_.matrixL().solve(v); }
  Eigen::MatrixXd design_of(double exponent) const {
    Eigen::VectorXd tail(one_.size());
    for (Eigen::Index i = 0; i < tail.size(); i++)
      tail[i] = power(curve_.time[static_cast<std::size_t>(i)], exponent);
    Eigen::MatrixXd design(one_.size(), 2);
    design.col(0) = one_, design.col(1) = whitened(tail);
    return design;
  }
  Eigen::VectorXd solved(const Eigen::MatrixXd &design) const {
    return (design.transpose() * design).ldlt().solve(design.transpose() * value_);
  }
  const DiffusivityCurve &curve_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd value_, one_;
};

// The exponent of the least chi2: the best of a grid, then the golden section around it.
double best_exponent(const Fit &fit) {
  constexpr int steps = 60;
  const double ratio = conceg_log(most_exponent / least_exponent) / steps;
  const auto at = [&](int i) { return least_exponent * conceg_exp(ratio * i); };
  int best = 0;
  for (int i = 1; i <= steps; i++)
    if (fit.chi2(at(i)) < fit.chi2(at(best))) best = i;
  double low = at(std::max(0, best - 1)), high = at(std::min(steps, best + 1));
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 60; i++) {
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    if (fit.chi2(left) < fit.chi2(right))
      high = right;
    else
      low = left;
  }
  return 0.5 * (low + high);
}

// Whether chi2 is larger than 999 of 1000 are (Wilson and Hilferty's approximation).
bool is_rejected(double chi2, std::size_t degrees) {
  if (!degrees) return false;
  const double k = static_cast<double>(degrees), spread = 2.0 / (9.0 * k);
  return (std::cbrt(chi2 / k) - (1.0 - spread)) / std::sqrt(spread) > 3.09;
}

Tail void_tail(const char *why) {
  Tail out;
  out.state = std::string("void: ") + why;
  return out;
}

} // namespace

DiffusivityCurve diffusivity_curve(const std::vector<const glm::dvec3 *> &moved,
                                   const std::vector<double> &time, const std::vector<std::uint32_t> &walker,
                                   int axis) {
  const std::size_t times = time.size();
  const double n = static_cast<double>(walker.size());
  DiffusivityCurve out;
  out.time = time, out.value.assign(times, 0.0), out.covariance.assign(times * times, 0.0);
  out.walkers = walker.size();
  if (walker.size() < 2) return out;
  for (std::size_t t = 0; t < times; t++) {
    for (const std::uint32_t w : walker)
      out.value[t] += component(moved[t][w], axis) / (2.0 * time[t]);
    out.value[t] /= n;
  }
  std::vector<double> off(times);
  for (const std::uint32_t w : walker) {
    for (std::size_t t = 0; t < times; t++)
      off[t] = component(moved[t][w], axis) / (2.0 * time[t]) - out.value[t];
    for (std::size_t a = 0; a < times; a++)
      for (std::size_t b = 0; b <= a; b++)
        out.covariance[a * times + b] += off[a] * off[b];
  }
  for (std::size_t a = 0; a < times; a++)
    for (std::size_t b = 0; b <= a; b++)
      out.covariance[b * times + a] = out.covariance[a * times + b] /= n * (n - 1.0);
  return out;
}

Tail fit_tail(const DiffusivityCurve &curve, double exponent) {
  const bool is_free = !(exponent > 0.0);
  const std::size_t parameters = is_free ? 3 : 2;
  if (curve.time.size() < parameters + 2) return void_tail("too few times");
  if (!(curve.time.back() >= 3.0 * curve.time.front()))
    return void_tail("times span less than a factor of 3");
  if (curve.walkers && curve.walkers < walkers_a_time * curve.time.size())
    return void_tail("too few walkers");
  const Fit fit(curve);
  if (!fit.is_definite()) return void_tail("too few walkers");
  if (is_free) {
    exponent = best_exponent(fit);
    if (!(fit.chi2_of_constant() - fit.chi2(exponent) > time_dependence))
      return void_tail("D does not depend on time beyond its error");
    if (exponent < 1.001 * least_exponent) return void_tail("no limit in sight: the walk is too short");
    if (exponent > 0.999 * most_exponent) return void_tail("faster than a power of time");
  }
  Tail out = fit.tail(exponent, static_cast<Eigen::Index>(parameters));
  const double end = curve.time.back(), rest = out.amplitude.value * power(end, exponent);
  if (out.limit.value < -3.0 * out.limit.error)
    return void_tail("its limit would be negative: the walk is too short");
  if (out.limit.value > 3.0 * out.limit.error && rest > out.limit.value)
    return void_tail("D is still more than twice its limit: the walk is too short");
  if (is_free && !(out.exponent.error <= most_exponent_error))
    return void_tail("too few walkers for an exponent");
  if (!(out.limit.error <= curve.value.back())) return void_tail("too few walkers for a limit");
  out.state = is_rejected(out.chi2, out.degrees) ? "rejected" : "fitted";
  return out;
}

} // namespace conceg::analyse
