// SPDX-License-Identifier: BSD-3-Clause
// BlueBrain's h5v1: /points rows x y z diameter, /structure rows (first point, type, section before), as
// plain arrays.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::exporting {

struct H5Morphology {
  std::vector<double> points;          // [n][4], um
  std::vector<std::int32_t> structure; // [sections][3]; row 0 is the soma
};

// The bytes of the file.
std::string h5v1_bytes(const H5Morphology &morphology);

} // namespace conceg::exporting
