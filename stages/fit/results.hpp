// SPDX-License-Identifier: BSD-3-Clause
// Fits -> tables and lines.
#pragma once

#include "geometry.hpp"
#include "read.hpp"
#include "statistics_table.hpp"

#include <string>
#include <vector>

namespace conceg::fit {

struct Result {
  std::string signal; // name
  Timing timing;
  Model model;
  Averages averages;
  SandiFit fit;
  bool intracellular = false;
};

std::string model_name(const Result &result);  // reduced, full
std::string kernel_name(const Result &result); // gpd, exact
// Of the parameters that are marked in `which`, separated by blanks.
std::string listed(const std::array<bool, parameters> &which);

// sandi: a row per fit; sandi_shell: a row per fit and shell; sandi_covariance; sandi_truth.
std::vector<Table> tables(const std::vector<Result> &results, const Truth &truth);
// A paragraph per fit with the truth beside it.
std::vector<std::string> lines(const std::vector<Result> &results, const Truth &truth);

} // namespace conceg::fit
