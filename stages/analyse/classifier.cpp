// SPDX-License-Identifier: BSD-3-Clause
#include "classifier.hpp"

#include <Eigen/Dense>

#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace conceg::analyse {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

struct Moments {
  double weight = 0;
  Vector mean;
};

template <class Chosen>
Moments moments(const std::vector<Labelled> &members, Eigen::Index size, Chosen chosen) {
  Moments out;
  out.mean = Vector::Zero(size);
  for (const Labelled &m : members)
    if (chosen(m)) out.weight += m.weight, out.mean += m.weight * Eigen::Map<const Vector>(m.measures, size);
  if (out.weight > 0) out.mean /= out.weight;
  return out;
}

// The direction along which the first sample scores higher; empty when a sample is missing. Two origins are
// left out.
Vector discriminant(const std::vector<Labelled> &members, std::uint32_t one, std::uint32_t other,
                    Eigen::Index size, double ridge) {
  const auto training = [&](const Labelled &m) {
    return m.origin != one && m.origin != other && m.weight > 0;
  };
  const Moments all = moments(members, size, training);
  const Moments first = moments(members, size, [&](const Labelled &m) { return training(m) && m.first; });
  const Moments second = moments(members, size, [&](const Labelled &m) { return training(m) && !m.first; });
  if (!(first.weight > 0 && second.weight > 0)) return {};
  Vector variance = Vector::Zero(size);
  Matrix within = Matrix::Zero(size, size);
  for (const Labelled &m : members) {
    if (!training(m)) continue;
    const Eigen::Map<const Vector> x(m.measures, size);
    variance += m.weight * (x - all.mean).cwiseAbs2();
    const Vector apart = x - (m.first ? first.mean : second.mean);
    within += m.weight * (apart * apart.transpose());
  }
  // A measure that does not vary says nothing.
  Vector scale(size);
  for (Eigen::Index k = 0; k < size; k++)
    scale[k] = variance[k] > 0 ? 1.0 / std::sqrt(variance[k] / all.weight) : 0.0;
  within = scale.asDiagonal() * (within / all.weight) * scale.asDiagonal();
  within.diagonal().array() += ridge;
  const Vector direction = within.ldlt().solve(scale.cwiseProduct(first.mean - second.mean));
  return scale.cwiseProduct(direction);
}

} // namespace

double cross_validated_auc(const std::vector<Labelled> &members, std::size_t measures, double ridge) {
  const auto size = static_cast<Eigen::Index>(measures);
  std::map<std::uint32_t, std::set<std::uint32_t>> origins; // of the first sample, by fold
  for (const Labelled &m : members)
    if (m.first && m.weight > 0) origins[m.fold].insert(m.origin);
  double sum = 0, weight = 0;
  for (const auto &[fold, firsts] : origins) {
    double right = 0, pairs = 0, seconds = 0;
    for (const Labelled &m : members)
      if (!m.first && m.fold == fold) seconds += m.weight;
    if (!(seconds > 0)) continue;
    for (const std::uint32_t origin : firsts) {
      const Vector direction = discriminant(members, origin, fold, size, ridge);
      if (!direction.size()) continue;
      const auto score = [&](const Labelled &m) {
        return direction.dot(Eigen::Map<const Vector>(m.measures, size));
      };
      for (const Labelled &two : members) {
        if (two.first || two.fold != fold || !(two.weight > 0)) continue;
        const double low = score(two);
        for (const Labelled &one : members) {
          if (!one.first || one.fold != fold || one.origin != origin || !(one.weight > 0)) continue;
          const double high = score(one), pair = one.weight * two.weight;
          pairs += pair, right += pair * (high > low ? 1.0 : high == low ? 0.5 : 0.0);
        }
      }
    }
    if (pairs > 0) sum += seconds * (right / pairs), weight += seconds;
  }
  return weight > 0 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
}

} // namespace conceg::analyse
