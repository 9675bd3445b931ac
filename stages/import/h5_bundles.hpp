// SPDX-License-Identifier: BSD-3-Clause
// fastpli's HDF5 files: groups 0, 1, ... of bundles with datasets 0, 1, ... of fibres, n rows of x y z r.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::importing {

struct BundleFibre {
  std::string bundle, fibre;
  std::vector<double> row; // n x 4
};

// In the order of their numbers. E_FORMAT names file and path; at most `memory` bytes are taken.
std::vector<BundleFibre> read_h5_bundles(const std::string &path, std::uint64_t memory);

} // namespace conceg::importing
