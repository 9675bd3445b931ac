// SPDX-License-Identifier: BSD-3-Clause
// The morphological dictionary as plain arrays: entry > donor > tree > bar (spec/schema.yaml says what each
// one holds).
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::place {

struct Entries {
  std::vector<std::string> name, class_name, note; // note: may be empty
  std::vector<std::uint64_t> donor_offset, angle_offset;
  std::vector<double> straightness, straightness_sd; // may be empty
};
struct Donors {
  std::vector<std::string> id, frame_kind;     // frame_kind: "apical", "axis", "unknown"; may be empty
  std::vector<std::string> pooled_from, trace; // may be empty
  std::vector<std::uint32_t> source;           // row of the sources; may be empty
  std::vector<std::uint8_t> fold;              // may be empty
  std::vector<std::uint8_t> validation;        // 1 = held back from synthesis; may be empty
  std::vector<double> frame;                   // 4 per donor: w x y z; may be empty
  std::vector<double> soma_radius;             // um
  std::vector<std::uint64_t> tree_offset;
};
struct Trees {
  std::vector<std::uint8_t> neurite; // SWC code
  std::vector<glm::dvec3> trunk_direction;
  std::vector<std::uint64_t> bar_offset;
};
struct DictionaryBars {
  std::vector<double> birth, death, radius, taper;
  std::vector<double> cv, correlation_length; // may be empty
  std::vector<double> angle, tip_distance;
  std::vector<std::int64_t> parent; // row within the tree, -1 = root bar
  std::vector<glm::dvec3> tip_direction;
};

// Where donors come from.
struct Sources {
  std::vector<std::string> name, repository, licence, terms;
};
// How the radii of an entry's neurites vary.
struct Calibres {
  std::vector<std::uint32_t> entry, donors;
  std::vector<std::uint8_t> neurite;
  std::vector<std::string> trace;
  std::vector<double> radius, cv, correlation_length;
};

// What has one row per entry, donor, tree or bar: `visit(path, need, columns, arrays of the tables ...)` for
// each. Reading, writing and taking a subset go through these lists, so an item is a member above and a line
// here.
enum class Need { required, optional };

template <class Visit, class... Table> void each_entry_item(Visit visit, Table &...entry) {
  visit("/dictionary/entry_name", Need::required, 1, entry.name...);
  visit("/dictionary/entry_class", Need::required, 1, entry.class_name...);
  visit("/dictionary/entry_note", Need::optional, 1, entry.note...);
  visit("/dictionary/entry_straightness", Need::optional, 1, entry.straightness...);
  visit("/dictionary/entry_straightness_sd", Need::optional, 1, entry.straightness_sd...);
}
template <class Visit, class... Table> void each_donor_item(Visit visit, Table &...donor) {
  visit("/dictionary/donor_id", Need::required, 1, donor.id...);
  visit("/dictionary/donor_fold", Need::optional, 1, donor.fold...);
  visit("/dictionary/donor_validation", Need::optional, 1, donor.validation...);
  visit("/dictionary/donor_frame", Need::optional, 4, donor.frame...);
  visit("/dictionary/donor_frame_kind", Need::optional, 1, donor.frame_kind...);
  visit("/dictionary/donor_soma_radius", Need::required, 1, donor.soma_radius...);
  visit("/dictionary/donor_pooled_from", Need::optional, 1, donor.pooled_from...);
  visit("/dictionary/donor_trace", Need::optional, 1, donor.trace...);
  visit("/dictionary/donor_source", Need::optional, 1, donor.source...);
}
template <class Visit, class... Table> void each_source_item(Visit visit, Table &...source) {
  visit("/dictionary/source_name", Need::optional, 1, source.name...);
  visit("/dictionary/source_repository", Need::optional, 1, source.repository...);
  visit("/dictionary/source_licence", Need::optional, 1, source.licence...);
  visit("/dictionary/source_terms", Need::optional, 1, source.terms...);
}
template <class Visit, class... Table> void each_calibre_item(Visit visit, Table &...calibre) {
  visit("/dictionary/calibre_entry", Need::optional, 1, calibre.entry...);
  visit("/dictionary/calibre_neurite", Need::optional, 1, calibre.neurite...);
  visit("/dictionary/calibre_donors", Need::optional, 1, calibre.donors...);
  visit("/dictionary/calibre_trace", Need::optional, 1, calibre.trace...);
  visit("/dictionary/calibre_radius", Need::optional, 1, calibre.radius...);
  visit("/dictionary/calibre_cv", Need::optional, 1, calibre.cv...);
  visit("/dictionary/calibre_correlation_length", Need::optional, 1, calibre.correlation_length...);
}
template <class Visit, class... Table> void each_tree_item(Visit visit, Table &...tree) {
  visit("/dictionary/tree_neurite", Need::required, 1, tree.neurite...);
  visit("/dictionary/tree_trunk_direction", Need::required, 1, tree.trunk_direction...);
}
template <class Visit, class... Table> void each_bar_item(Visit visit, Table &...bar) {
  visit("/dictionary/bar_birth", Need::required, 1, bar.birth...);
  visit("/dictionary/bar_death", Need::required, 1, bar.death...);
  visit("/dictionary/bar_parent", Need::required, 1, bar.parent...);
  visit("/dictionary/bar_radius", Need::required, 1, bar.radius...);
  visit("/dictionary/bar_taper", Need::required, 1, bar.taper...);
  visit("/dictionary/bar_cv", Need::optional, 1, bar.cv...);
  visit("/dictionary/bar_correlation_length", Need::optional, 1, bar.correlation_length...);
  visit("/dictionary/bar_angle", Need::required, 1, bar.angle...);
  visit("/dictionary/bar_tip_direction", Need::required, 1, bar.tip_direction...);
  visit("/dictionary/bar_tip_distance", Need::required, 1, bar.tip_distance...);
}

struct Dictionary {
  Entries entry;
  std::vector<double> angle; // rad, of all entries
  Donors donor;
  Trees tree;
  DictionaryBars bar;
  Sources source;
  Calibres calibre;

  // Row of the entry, or -1.
  std::int64_t find(const std::string &name) const;
};

// Only these entries, in this order.
Dictionary subset(const Dictionary &whole, const std::vector<std::size_t> &entries);

// The rows of a tree's bars, parents before children; throws where a parent is out of range or a cycle, or a
// bar has no length.
std::vector<std::size_t> parents_first(const Dictionary &dictionary, std::size_t tree);

} // namespace conceg::place
