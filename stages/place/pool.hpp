// SPDX-License-Identifier: BSD-3-Clause
// What the cells of an entry may draw from: donors, their trees, fork angles. Donors that are held back for a
// comparison are in none of it.
#pragma once

#include "dictionary.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace conceg::place {

// Marks the donors of this fold as held back, or none when it is negative. Gives the names of the entries
// that have no donor of the fold; throws where an entry is left without donors, or where folds are not known.
std::vector<std::string> hold_back(Dictionary &dictionary, std::int64_t fold);

struct PooledTree {
  std::size_t tree, donor; // rows
};

struct Pool {
  std::vector<std::size_t> donors;              // rows
  std::array<std::vector<PooledTree>, 8> trees; // by SWC code; those that have bars
  std::vector<double> angles;                   // rad, of forks
};

Pool pool_of(const Dictionary &dictionary, std::size_t entry);

} // namespace conceg::place
