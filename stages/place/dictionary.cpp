// SPDX-License-Identifier: BSD-3-Clause
#include "dictionary.hpp"

#include "guard.hpp"

#include <algorithm>
#include <numeric>

namespace conceg::place {
namespace {

// Appends rows first .. last - 1 of an array that may have been left out.
template <class T>
void append(std::vector<T> &to, const std::vector<T> &from, std::size_t first, std::size_t last,
            std::size_t width = 1) {
  if (from.empty()) return;
  to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(first * width),
            from.begin() + static_cast<std::ptrdiff_t>(last * width));
}

void append_bars(Dictionary &to, const DictionaryBars &from, std::size_t first, std::size_t last) {
  append(to.bar.birth, from.birth, first, last);
  append(to.bar.death, from.death, first, last);
  append(to.bar.radius, from.radius, first, last);
  append(to.bar.taper, from.taper, first, last);
  append(to.bar.cv, from.cv, first, last);
  append(to.bar.correlation_length, from.correlation_length, first, last);
  append(to.bar.angle, from.angle, first, last);
  append(to.bar.tip_distance, from.tip_distance, first, last);
  append(to.bar.parent, from.parent, first, last);
  append(to.bar.tip_direction, from.tip_direction, first, last);
}

void append_donor(Dictionary &to, const Dictionary &from, std::size_t donor) {
  append(to.donor.id, from.donor.id, donor, donor + 1);
  append(to.donor.frame_kind, from.donor.frame_kind, donor, donor + 1);
  append(to.donor.fold, from.donor.fold, donor, donor + 1);
  append(to.donor.frame, from.donor.frame, donor, donor + 1, 4);
  append(to.donor.soma_radius, from.donor.soma_radius, donor, donor + 1);
  for (std::size_t tree = from.donor.tree_offset[donor]; tree < from.donor.tree_offset[donor + 1]; tree++) {
    append(to.tree.neurite, from.tree.neurite, tree, tree + 1);
    append(to.tree.trunk_direction, from.tree.trunk_direction, tree, tree + 1);
    append_bars(to, from.bar, from.tree.bar_offset[tree], from.tree.bar_offset[tree + 1]);
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
    append(out.entry.name, whole.entry.name, entry, entry + 1);
    append(out.entry.class_name, whole.entry.class_name, entry, entry + 1);
    append(out.entry.note, whole.entry.note, entry, entry + 1);
    append(out.entry.straightness, whole.entry.straightness, entry, entry + 1);
    append(out.entry.straightness_sd, whole.entry.straightness_sd, entry, entry + 1);
    append(out.angle, whole.angle, whole.entry.angle_offset[entry], whole.entry.angle_offset[entry + 1]);
    out.entry.angle_offset.push_back(out.angle.size());
    for (std::size_t donor = whole.entry.donor_offset[entry]; donor < whole.entry.donor_offset[entry + 1];
         donor++)
      append_donor(out, whole, donor);
    out.entry.donor_offset.push_back(out.donor.id.size());
  }
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
