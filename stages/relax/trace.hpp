// SPDX-License-Identifier: BSD-3-Clause
// What the tissue was like as it relaxed: a table and a figure.
#pragma once

#include "forces.hpp"
#include "fraction.hpp"

#include <string>
#include <vector>

namespace conceg::relax {

struct Step {
  int iteration;
  State state;
  Fractions fractions; // at the target radii
};

// CSV; whole or not at all. E_IO when it cannot be written.
void write_table(const std::string &path, const std::vector<Step> &steps);

// folder/relaxation.svg, the folder made when absent. E_UNSUPPORTED in a build without Cairo.
void write_figure(const std::string &folder, const std::vector<Step> &steps);

} // namespace conceg::relax
