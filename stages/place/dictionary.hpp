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
  std::vector<std::string> id, frame_kind; // frame_kind: "apical", "axis", "unknown"; may be empty
  std::vector<std::uint8_t> fold;          // may be empty
  std::vector<double> frame;               // 4 per donor: w x y z; may be empty
  std::vector<double> soma_radius;         // um
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

struct Dictionary {
  Entries entry;
  std::vector<double> angle; // rad, of all entries
  Donors donor;
  Trees tree;
  DictionaryBars bar;

  // Row of the entry, or -1.
  std::int64_t find(const std::string &name) const;
};

// Only these entries, in this order.
Dictionary subset(const Dictionary &whole, const std::vector<std::size_t> &entries);

// The rows of a tree's bars, parents before children; throws where a parent is out of range or a cycle, or a
// bar has no length.
std::vector<std::size_t> parents_first(const Dictionary &dictionary, std::size_t tree);

} // namespace conceg::place
