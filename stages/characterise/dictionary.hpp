// SPDX-License-Identifier: BSD-3-Clause
// The dictionary as arrays: entry > donor > tree > bar, as /dictionary of spec/schema.yaml holds it.
#pragma once

#include "calibre.hpp"
#include "frame.hpp"
#include "morphology.hpp"

#include <map>
#include <string>
#include <utility>

namespace conceg::characterise {

struct Dictionary {
  std::vector<std::string> entry_name, entry_class, entry_note;
  std::vector<std::uint64_t> entry_donor_offset{0}, entry_angle_offset{0};
  std::vector<double> entry_straightness, entry_straightness_sd, angle;

  std::vector<std::string> donor_id, donor_frame_kind, donor_pooled_from, donor_trace;
  std::vector<std::uint32_t> donor_source; // empty without a table of sources
  std::vector<std::uint8_t> donor_fold;
  std::vector<Rotation> donor_frame;
  std::vector<double> donor_soma_radius;
  std::vector<std::uint64_t> donor_tree_offset{0};

  std::vector<std::uint8_t> tree_neurite;
  std::vector<glm::dvec3> tree_trunk_direction;
  std::vector<std::uint64_t> tree_bar_offset{0};

  std::vector<double> bar_birth, bar_death, bar_radius, bar_taper, bar_cv, bar_correlation_length, bar_angle,
      bar_tip_distance;
  std::vector<std::int64_t> bar_parent;
  std::vector<glm::dvec3> bar_tip_direction;

  // One row per entry and neurite: the radii of its donors' bars together.
  std::vector<std::uint32_t> calibre_entry, calibre_donors;
  std::vector<std::uint8_t> calibre_neurite;
  std::vector<std::string> calibre_trace;
  std::vector<double> calibre_radius, calibre_cv, calibre_correlation_length;
};

// What an entry collects from its donors until it is closed.
struct EntrySums {
  std::vector<double> angles;
  double straight = 0.0, straight_squared = 0.0;
  std::size_t branches = 0;
  struct Radii {
    CalibrePool pool;
    std::uint32_t donors = 0;
  };
  std::map<std::pair<int, Trace>, Radii> radii; // by neurite and by how finely it was traced
};

struct Donor {
  std::string id, frame_kind, pooled_from;
  std::int64_t source = -1; // row of the table of sources
  Trace trace = Trace::none;
  std::uint8_t fold = 0;
  Rotation frame{1.0, 0.0, 0.0, 0.0};
};

// Figures of one cell, for the log; the radius is the mean along its dendrites.
struct CellFigures {
  std::size_t trees = 0, bars = 0;
  double cable = 0.0, radius = 0.0;
};

void open_entry(Dictionary &dictionary, const std::string &name, const std::string &cell_class,
                const std::string &note);
// Adds a cell as a donor of the open entry; its trees must not be empty.
CellFigures add_cell(Dictionary &dictionary, EntrySums &sums, const Donor &donor, const Cell &cell);
void close_entry(Dictionary &dictionary, const EntrySums &sums);

// One bar whose measures are known already (entries that are made from statistics).
struct BarRow {
  double birth, death, radius, taper, angle, tip_distance;
  std::int64_t parent;
  glm::dvec3 tip_direction;
};
struct BarTree {
  int neurite = neurite_glia;
  glm::dvec3 trunk_direction{0.0, 0.0, 1.0};
  std::vector<BarRow> bars;
};
void add_bar_trees(Dictionary &dictionary, const Donor &donor, double soma_radius,
                   const std::vector<BarTree> &trees);

} // namespace conceg::characterise
