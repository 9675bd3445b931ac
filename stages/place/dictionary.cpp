// SPDX-License-Identifier: BSD-3-Clause
#include "dictionary.hpp"

#include "guard.hpp"

#include <algorithm>
#include <numeric>

namespace conceg::place {
namespace {

// Appends rows first .. last - 1 of each array of a table; one that was left out stays so.
auto copy_rows(std::size_t first, std::size_t last) {
  return [=](const char *, Need, std::size_t columns, auto &to, const auto &from) {
    if (from.empty()) return;
    to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(first * columns),
              from.begin() + static_cast<std::ptrdiff_t>(last * columns));
  };
}

void append_donor(Dictionary &to, const Dictionary &from, std::size_t donor) {
  each_donor_item(copy_rows(donor, donor + 1), to.donor, from.donor);
  for (std::size_t tree = from.donor.tree_offset[donor]; tree < from.donor.tree_offset[donor + 1]; tree++) {
    each_tree_item(copy_rows(tree, tree + 1), to.tree, from.tree);
    each_bar_item(copy_rows(from.tree.bar_offset[tree], from.tree.bar_offset[tree + 1]), to.bar, from.bar);
    to.tree.bar_offset.push_back(to.bar.birth.size());
  }
  to.donor.tree_offset.push_back(to.tree.neurite.size());
}

} // namespace

std::int64_t Dictionary::find(const std::string &name) const {
  const auto found = std::find(entry.name.begin(), entry.name.end(), name);
  return found == entry.name.end() ? -1 : found - entry.name.begin();
}

Dictionary subset(const Dictionary &whole, const std::vector<std::size_t> &entries) {
  Dictionary out;
  out.entry.donor_offset = out.entry.angle_offset = out.donor.tree_offset = out.tree.bar_offset = {0};
  for (const std::size_t entry : entries) {
    each_entry_item(copy_rows(entry, entry + 1), out.entry, whole.entry);
    const auto angles = copy_rows(whole.entry.angle_offset[entry], whole.entry.angle_offset[entry + 1]);
    angles("/dictionary/angle", Need::optional, 1, out.angle, whole.angle);
    out.entry.angle_offset.push_back(out.angle.size());
    for (std::size_t donor = whole.entry.donor_offset[entry]; donor < whole.entry.donor_offset[entry + 1];
         donor++)
      append_donor(out, whole, donor);
    for (std::size_t row = 0; row < whole.calibre.entry.size(); row++)
      if (whole.calibre.entry[row] == entry) {
        each_calibre_item(copy_rows(row, row + 1), out.calibre, whole.calibre);
        out.calibre.entry.back() = static_cast<std::uint32_t>(out.entry.donor_offset.size() - 1);
      }
    out.entry.donor_offset.push_back(out.donor.id.size());
  }
  out.source = whole.source;
  return out;
}

std::vector<std::size_t> parents_first(const Dictionary &dictionary, std::size_t tree) {
  const std::size_t first = dictionary.tree.bar_offset[tree],
                    count = dictionary.tree.bar_offset[tree + 1] - first;
  std::vector<std::size_t> depth(count);
  for (std::size_t i = 0; i < count; i++) {
    if (!(dictionary.bar.death[first + i] > dictionary.bar.birth[first + i]))
      fail(CONCEG_E_FORMAT, "/dictionary/bar_death[%zu]: expected more than bar_birth = %g um, got %g um",
           first + i, dictionary.bar.birth[first + i], dictionary.bar.death[first + i]);
    for (std::size_t at = i; dictionary.bar.parent[first + at] != -1; depth[i]++) {
      const std::int64_t parent = dictionary.bar.parent[first + at];
      if (parent < -1 || parent >= static_cast<std::int64_t>(count))
        fail(CONCEG_E_FORMAT,
             "/dictionary/bar_parent[%zu]: expected a row of its tree below %zu, or -1, got %lld", first + at,
             count, static_cast<long long>(parent));
      if (depth[i] == count)
        fail(CONCEG_E_FORMAT, "/dictionary/bar_parent[%zu]: expected a tree, got a cycle", first + i);
      at = static_cast<std::size_t>(parent);
    }
  }
  std::vector<std::size_t> rows(count);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return depth[a] < depth[b]; });
  return rows;
}

} // namespace conceg::place
