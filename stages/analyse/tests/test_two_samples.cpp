// SPDX-License-Identifier: BSD-3-Clause
// Effect sizes, distances of distributions and the classifier on samples whose answers are known.
#include "../classifier.hpp"
#include "../two_samples.hpp"
#include "check.h"
#include "conceg/rng.h"

#include <cmath>

using namespace conceg::analyse;

namespace {

std::vector<double> normals(std::size_t count, double mean, double sd, std::uint64_t id) {
  conceg_rng rng = conceg_rng_stream(7, "test.two_samples", id);
  std::vector<double> out;
  for (std::size_t i = 0; i < count; i++)
    out.push_back(mean + sd * conceg_rng_normal(&rng));
  return out;
}

// The first cluster against the second.
TwoSamples compared(const std::vector<double> &a, const std::vector<double> &b) {
  return ClusteredValues({a, b}).compare({1, 0}, {0, 1});
}

double phi(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

void by_hand() {
  const TwoSamples two = compared({1, 2, 3}, {2, 4, 6, 8});
  CHECK_NEAR(two.a.count, 3, 0);
  CHECK_NEAR(two.a.mean, 2, 1e-15);
  CHECK_NEAR(two.a.sd, 1, 1e-15);
  CHECK_NEAR(two.b.mean, 5, 1e-15);
  CHECK_NEAR(two.b.sd, std::sqrt(20.0 / 3), 1e-14);
  CHECK_NEAR(two.cohens_d, -3 / std::sqrt((2 * 1.0 + 3 * 20.0 / 3) / 5), 1e-14);
  CHECK_NEAR(two.sd_ratio, 1 / std::sqrt(20.0 / 3), 1e-14);
  // F_a - F_b on [1,2) [2,3) [3,4) [4,6) [6,8): 1/3, 2/3 - 1/4, 1 - 1/4, 1/2, 1/4.
  CHECK_NEAR(two.wasserstein, 1.0 / 3 + 5.0 / 12 + 3.0 / 4 + 2 * 0.5 + 2 * 0.25, 1e-14);
  CHECK_NEAR(two.kolmogorov, 0.75, 1e-15);
  const TwoSamples turned = compared({2, 4, 6, 8}, {1, 2, 3});
  CHECK_NEAR(turned.cohens_d, -two.cohens_d, 1e-15);
  CHECK_NEAR(turned.wasserstein, two.wasserstein, 1e-15);
}

void ties() {
  const TwoSamples same = compared({1, 1, 2, 2, 2}, {1, 1, 2, 2, 2});
  CHECK_NEAR(same.wasserstein, 0, 0);
  CHECK_NEAR(same.kolmogorov, 0, 0); // between equal values there is no difference, whatever their order
  CHECK_NEAR(same.cohens_d, 0, 0);
  const TwoSamples shares = compared({1, 1, 1, 2}, {1, 2, 2, 2});
  CHECK_NEAR(shares.kolmogorov, 0.5, 1e-15);
  CHECK_NEAR(shares.wasserstein, 0.5, 1e-15);
  const TwoSamples flat = compared({3, 3}, {3, 3, 3});
  CHECK(std::isnan(flat.cohens_d) && std::isnan(flat.sd_ratio));
  CHECK_NEAR(flat.wasserstein, 0, 0);
}

void few_values() {
  const TwoSamples none = compared({}, {1, 2, 3});
  CHECK(std::isnan(none.cohens_d) && std::isnan(none.sd_ratio) && std::isnan(none.wasserstein) &&
        std::isnan(none.kolmogorov));
  CHECK_NEAR(none.a.count, 0, 0);
  CHECK_NEAR(none.b.mean, 2, 1e-15);
  const TwoSamples nothing = compared({}, {});
  CHECK(std::isnan(nothing.cohens_d) && std::isnan(nothing.kolmogorov));
  const TwoSamples one = compared({5}, {1, 2, 3}); // the sd is that of the others
  CHECK_NEAR(one.cohens_d, 3, 1e-14);
  CHECK(std::isnan(one.sd_ratio));
  CHECK_NEAR(one.wasserstein, 3, 1e-14);
  CHECK_NEAR(one.kolmogorov, 1, 0);
  const TwoSamples ones = compared({5}, {1});
  CHECK(std::isnan(ones.cohens_d));
  CHECK_NEAR(ones.wasserstein, 4, 0);
  const TwoSamples two = compared({0, 2}, {1, 3});
  CHECK_NEAR(two.cohens_d, -1 / std::sqrt(2.0), 1e-14);
}

// A weight counts as so many values.
void weights() {
  const ClusteredValues clusters({{1, 4}, {2}, {3, 5, 9}});
  const TwoSamples weighted = clusters.compare({2, 1, 0}, {0, 0, 3});
  const TwoSamples repeated = compared({1, 4, 1, 4, 2}, {3, 5, 9, 3, 5, 9, 3, 5, 9});
  CHECK_NEAR(weighted.a.count, 5, 0);
  CHECK_NEAR(weighted.cohens_d, repeated.cohens_d, 1e-13);
  CHECK_NEAR(weighted.sd_ratio, repeated.sd_ratio, 1e-13);
  CHECK_NEAR(weighted.wasserstein, repeated.wasserstein, 1e-13);
  CHECK_NEAR(weighted.kolmogorov, repeated.kolmogorov, 1e-13);
}

void shifted_normals() {
  constexpr std::size_t many = 40000;
  constexpr double shift = 0.6;
  const TwoSamples two = compared(normals(many, shift, 1, 1), normals(many, 0, 1, 2));
  CHECK_NEAR(two.cohens_d, shift, 0.03); // 4 standard errors
  CHECK_NEAR(two.wasserstein, shift, 0.03);
  CHECK_NEAR(two.kolmogorov, 2 * phi(shift / 2) - 1, 0.015);
  CHECK_NEAR(two.sd_ratio, 1, 0.02);
  const TwoSamples wider = compared(normals(many, 0, 1.5, 3), normals(many, 0, 1, 4));
  CHECK_NEAR(wider.sd_ratio, 1.5, 0.03);
  CHECK_NEAR(wider.cohens_d, 0, 0.03);
  CHECK_NEAR(wider.wasserstein, 0.5 * std::sqrt(2 / 3.14159265358979), 0.03); // E abs(z) times 0.5
}

// Tabulated: Q(0.82757) = 0.50, Q(1.2238) = 0.10, Q(1.3581) = 0.05, Q(1.6276) = 0.01 of Kolmogorov's law.
void probabilities() {
  const double n = 1e8, root = std::sqrt(n / 2);
  CHECK_NEAR(kolmogorov_p(0.82757 / root, n, n), 0.50, 1e-4);
  CHECK_NEAR(kolmogorov_p(1.2238 / root, n, n), 0.10, 1e-4);
  CHECK_NEAR(kolmogorov_p(1.3581 / root, n, n), 0.05, 1e-4);
  CHECK_NEAR(kolmogorov_p(1.6276 / root, n, n), 0.01, 1e-4);
  CHECK_NEAR(kolmogorov_p(0, 10, 10), 1, 0);
  CHECK(kolmogorov_p(1, 10, 10) < 1e-4);
}

void quantiles_and_means() {
  CHECK_NEAR(quantile_of({4, 1, NAN, 3, 2}, 0.5), 2, 0);
  CHECK_NEAR(quantile_of({4, 1, 3, 2}, 0.95), 4, 0);
  CHECK_NEAR(quantile_of({4, 1, 3, 2}, 0.0), 1, 0);
  CHECK(std::isnan(quantile_of({NAN}, 0.5)) && std::isnan(mean_of_known({NAN})));
  CHECK_NEAR(mean_of_known({1, NAN, 3}), 2, 0);
}

// Two normals in `size` measures, the first moved by `shift` along each.
double auc(std::size_t count, std::size_t size, double shift, std::uint32_t folds, std::uint64_t id) {
  const std::vector<double> a = normals(count * size, shift, 1, id), b = normals(count * size, 0, 1, id + 1);
  std::vector<Labelled> members;
  for (std::size_t i = 0; i < count; i++) {
    const std::uint32_t fold = static_cast<std::uint32_t>(i) % folds;
    members.push_back({&a[i * size], true, fold, fold}), members.push_back({&b[i * size], false, fold, fold});
  }
  return cross_validated_auc(members, size);
}

void classifier() {
  for (const double d : {0.5, 1.0, 2.0})
    CHECK_NEAR(auc(3000, 1, d, 5, 10), phi(d / std::sqrt(2.0)), 0.015);
  CHECK_NEAR(auc(3000, 4, 0.5, 5, 20), phi(1.0 / std::sqrt(2.0)), 0.015); // d = 0.5 sqrt 4 along the diagonal
  CHECK_NEAR(auc(3000, 4, 0.0, 5, 30), 0.5, 0.03);                        // nothing to be found
  // Chance stays chance with few members: cross-validation does not judge what it was trained on.
  double mean = 0;
  for (std::uint64_t k = 0; k < 200; k++)
    mean += auc(6, 6, 0.0, 5, 100 + 2 * k) / 200;
  CHECK_NEAR(mean, 0.5, 0.06);
  CHECK_NEAR(auc(4, 2, 50.0, 4, 40), 1, 0);
  CHECK(std::isnan(auc(3, 2, 0.0, 1, 50))); // one fold: nothing is left to train on
  const double value = 1;
  CHECK(std::isnan(cross_validated_auc({{&value, true, 0, 0}, {&value, true, 1, 1}}, 1)));
  CHECK(std::isnan(cross_validated_auc({}, 1)));
  // A measure that does not vary says nothing.
  const double flat[] = {2, 2, 2, 2};
  CHECK_NEAR(
      cross_validated_auc(
          {{flat, true, 0, 0}, {flat + 1, false, 0, 0}, {flat + 2, true, 1, 1}, {flat + 3, false, 1, 1}}, 1),
      0.5, 0);
}

// Copies of the second sample, each judged in the fold after that of what it is a copy of: there is nothing
// to be found. A discriminant that has seen the copies of whom it judges is worse than chance.
double auc_of_copies(bool told, std::uint64_t id) {
  constexpr std::size_t count = 20, size = 6;
  const std::vector<double> b = normals(count * size, 0, 1, id),
                            noise = normals(count * size, 0, 0.3, id + 1);
  std::vector<double> a(b.size());
  for (std::size_t i = 0; i < a.size(); i++)
    a[i] = b[i] + noise[i];
  std::vector<Labelled> members;
  for (std::uint32_t i = 0; i < count; i++) {
    const std::uint32_t fold = i % 5, next = (fold + 1) % 5;
    members.push_back({&b[i * size], false, fold, fold});
    members.push_back({&a[i * size], true, next, told ? fold : next});
  }
  return cross_validated_auc(members, size);
}
void copies() {
  double told = 0, untold = 0;
  for (std::uint64_t k = 0; k < 200; k++)
    told += auc_of_copies(true, 1000 + 2 * k) / 200, untold += auc_of_copies(false, 1000 + 2 * k) / 200;
  CHECK_NEAR(told, 0.5, 0.03);
  CHECK(untold < 0.40);
}

} // namespace

int main(void) {
  by_hand();
  ties();
  few_values();
  weights();
  shifted_normals();
  probabilities();
  quantiles_and_means();
  classifier();
  copies();
  return check_done();
}
