// SPDX-License-Identifier: BSD-3-Clause
#include "pool.hpp"

#include "conceg/swc.h"
#include "guard.hpp"

#include <algorithm>

namespace conceg::place {
namespace {

bool held_back(const Dictionary &dictionary, std::size_t donor) {
  return !dictionary.donor.validation.empty() && dictionary.donor.validation[donor] == 1;
}

void add_tree(const Dictionary &dictionary, std::size_t tree, std::size_t donor, Pool &pool) {
  const std::size_t first = dictionary.tree.bar_offset[tree], last = dictionary.tree.bar_offset[tree + 1];
  const std::uint8_t neurite = dictionary.tree.neurite[tree];
  if (first == last) return; // a cell that draws it would have a tree less than its donor
  pool.trees[neurite].push_back({tree, donor});
  // The entry's angles do not say whose they are, those of the bars do. Axons are in neither.
  if (dictionary.donor.validation.empty() || neurite == CONCEG_SWC_AXON) return;
  for (std::size_t bar = first; bar < last; bar++)
    if (dictionary.bar.parent[bar] != -1) pool.angles.push_back(dictionary.bar.angle[bar]);
}

} // namespace

std::vector<std::string> hold_back(Dictionary &dictionary, std::int64_t fold) {
  // A dictionary that comes from another document may carry the marks of that document's cells.
  dictionary.donor.validation.clear();
  std::vector<std::string> without;
  if (fold < 0) return without;
  if (dictionary.donor.fold.empty())
    fail(CONCEG_E_MISSING,
         "validation_fold: expected /dictionary/donor_fold in the dictionary, got none; give the donors "
         "folds in the table of characterise, or set validation_fold to -1");
  for (const std::uint8_t own : dictionary.donor.fold)
    dictionary.donor.validation.push_back(own == fold);
  for (std::size_t entry = 0; entry < dictionary.entry.name.size(); entry++) {
    const auto at = dictionary.donor.validation.begin();
    const auto first = at + static_cast<std::ptrdiff_t>(dictionary.entry.donor_offset[entry]),
               last = at + static_cast<std::ptrdiff_t>(dictionary.entry.donor_offset[entry + 1]);
    const auto held = std::count(first, last, std::uint8_t{1});
    if (held == 0) without.push_back(dictionary.entry.name[entry]);
    if (held > 0 && held == last - first)
      fail(CONCEG_E_RANGE,
           "validation_fold: expected donors beside those of fold %lld in dictionary entry %s, got none; "
           "choose another fold, or -1 to hold back none",
           static_cast<long long>(fold), dictionary.entry.name[entry].c_str());
  }
  return without;
}

Pool pool_of(const Dictionary &dictionary, std::size_t entry) {
  Pool pool;
  for (std::size_t donor = dictionary.entry.donor_offset[entry];
       donor < dictionary.entry.donor_offset[entry + 1]; donor++) {
    if (held_back(dictionary, donor)) continue;
    pool.donors.push_back(donor);
    for (std::size_t tree = dictionary.donor.tree_offset[donor];
         tree < dictionary.donor.tree_offset[donor + 1]; tree++)
      add_tree(dictionary, tree, donor, pool);
  }
  if (dictionary.donor.validation.empty()) {
    const auto at = dictionary.angle.begin();
    pool.angles.assign(at + static_cast<std::ptrdiff_t>(dictionary.entry.angle_offset[entry]),
                       at + static_cast<std::ptrdiff_t>(dictionary.entry.angle_offset[entry + 1]));
  }
  return pool;
}

} // namespace conceg::place
