// SPDX-License-Identifier: BSD-3-Clause
// How well two samples can be told apart by all measures together (Lopez-Paz and Oquab 2017).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conceg::analyse {

// One member of either sample. Members of one fold are judged by a discriminant that was trained on the
// others.
struct Labelled {
  const double *measures; // as many as told; finite
  bool first;             // of the first sample
  std::uint32_t fold;
  double weight = 1.0; // >= 0; 0 = not there
};

// Area under the ROC curve: the share of pairs (one of each sample, of one fold) that Fisher's linear
// discriminant ranks rightly, equal scores by half; mean of the folds by the weight of their second sample.
// Measures are standardised by the training members; the pooled covariance within the samples has `ridge`
// added to its diagonal, so that few members suffice. NaN when no fold holds both samples, with both among
// the others.
double cross_validated_auc(const std::vector<Labelled> &members, std::size_t measures, double ridge = 0.1);

} // namespace conceg::analyse
