// SPDX-License-Identifier: BSD-3-Clause
// How well two samples can be told apart by all measures together (Lopez-Paz and Oquab 2017).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conceg::analyse {

// One member of either sample. Pairs of both samples are judged within a fold, by a discriminant trained
// without the origins of either: what is made of the same as they are would give away its label, or that of
// the other.
struct Labelled {
  const double *measures; // as many as told; finite
  bool first;             // of the first sample
  std::uint32_t fold;
  std::uint32_t
      origin; // group of what it was made of; of the second sample, and of independent ones, the fold
  double weight = 1.0; // >= 0; 0 = not there
};

// Area under the ROC curve: the share of pairs (one of each sample, of one fold) that Fisher's linear
// discriminant ranks rightly, equal scores by half; mean of the folds by the weight of their second sample.
// Measures are standardised by the training members; the pooled covariance within the samples has `ridge`
// added to its diagonal, so that few members suffice. NaN when no fold holds both samples, with both among
// the origins left.
double cross_validated_auc(const std::vector<Labelled> &members, std::size_t measures, double ridge = 0.1);

} // namespace conceg::analyse
