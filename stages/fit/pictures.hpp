// SPDX-License-Identifier: BSD-3-Clause
// Fits beside the signals, as SVG files.
#pragma once

#include "results.hpp"

#include <string>
#include <vector>

namespace conceg::fit {

// Makes the folder; nothing without one. E_UNSUPPORTED in a build without Cairo.
void check_pictures(const std::string &folder);
// One file per signal: signals and fits against b, semilogarithmic, against 1 / sqrt(b), and residuals
// against b.
void draw_pictures(const std::string &folder, const std::vector<Result> &results);

} // namespace conceg::fit
