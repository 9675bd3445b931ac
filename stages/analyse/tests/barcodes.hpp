// SPDX-License-Identifier: BSD-3-Clause
// A dictionary of three donors in two entries, and what the three cells of tissue.hpp were asked for.
#pragma once

#include "../../common/tests/tissue.hpp"

namespace barcodes {

using namespace conceg;

struct Bar {
  double start, end;
  std::int64_t parent;
  double angle;
};
using Tree = std::vector<Bar>;

// Branches 3 5 4 um of order 1 2 2: means 4 um and 5/3; one fork of two, 1.2 rad.
inline const Tree simple = {{0, 8, -1, 0}, {3, 7, 0, 1.2}};
// Branches 4 6 | 2 3 | 2 | 2 um of order 1 2 | 2 3 | 2 | 3: means 19/6 um and 13/6; a fork of three and one
// of two, 1.4 rad.
inline const Tree bushy = {{0, 10, -1, 0}, {4, 9, 0, 1.0}, {4, 6, 0, 0.5}, {6, 8, 1, 1.4}};
inline const Tree single = {{0, 6, -1, 0}}, axon = {{0, 100, -1, 0}};

// Entries L23_pyramidal (first, second: bushy with an axon) and astrocyte (single).
inline void put_dictionary(conceg_doc *doc, const Tree &first, double straightness) {
  const std::vector<std::pair<std::uint8_t, Tree>> trees = {{3, first}, {3, bushy}, {2, axon}, {7, single}};
  std::vector<std::uint64_t> tree_bar = {0};
  std::vector<std::uint8_t> neurite;
  std::vector<double> birth, death, angle;
  std::vector<std::int64_t> parent;
  for (const auto &[kind, bars] : trees) {
    neurite.push_back(kind);
    for (const Bar &bar : bars)
      birth.push_back(bar.start), death.push_back(bar.end), angle.push_back(bar.angle),
          parent.push_back(bar.parent);
    tree_bar.push_back(birth.size());
  }
  const std::vector<double> ones(birth.size(), 1.0);
  const std::vector<glm::dvec3> up(birth.size(), {0, 0, 1});
  put_texts(doc, "/dictionary/entry_name", {"L23_pyramidal", "astrocyte"});
  put_texts(doc, "/dictionary/entry_class", {"pyramidal", "astrocyte"});
  put(doc, "/dictionary/entry_donor_offset", std::vector<std::uint64_t>{0, 2, 3});
  put(doc, "/dictionary/entry_angle_offset", std::vector<std::uint64_t>{0, 0, 0});
  put(doc, "/dictionary/angle", std::vector<double>{});
  put(doc, "/dictionary/entry_straightness", std::vector<double>{straightness, 0.68});
  put(doc, "/dictionary/entry_straightness_sd", std::vector<double>{0.1, 0.19});
  put_texts(doc, "/dictionary/donor_id", {"one", "two", "three"});
  put(doc, "/dictionary/donor_soma_radius", std::vector<double>{4, 4, 2});
  put(doc, "/dictionary/donor_tree_offset", std::vector<std::uint64_t>{0, 1, 3, 4});
  put(doc, "/dictionary/tree_neurite", neurite);
  put3(doc, "/dictionary/tree_trunk_direction", std::vector<glm::dvec3>(trees.size(), {0, 0, 1}));
  put(doc, "/dictionary/tree_bar_offset", tree_bar);
  put(doc, "/dictionary/bar_birth", birth), put(doc, "/dictionary/bar_death", death);
  put(doc, "/dictionary/bar_parent", parent), put(doc, "/dictionary/bar_angle", angle);
  put(doc, "/dictionary/bar_radius", ones),
      put(doc, "/dictionary/bar_taper", std::vector<double>(ones.size()));
  put3(doc, "/dictionary/bar_tip_direction", up), put(doc, "/dictionary/bar_tip_distance", ones);
}

struct Achieved {
  double start, end;
  std::uint8_t state;
};

// Two cells of the first type and one of the third; each was asked for one tree.
inline void put_bars(conceg_doc *doc, const std::vector<Tree> &asked, const std::vector<Achieved> &achieved) {
  std::vector<std::uint64_t> offset = {0};
  std::vector<double> start, end, angle, got_start, got_end;
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> state;
  for (const Tree &tree : asked) {
    for (const Bar &bar : tree)
      start.push_back(bar.start), end.push_back(bar.end), angle.push_back(bar.angle),
          parent.push_back(bar.parent);
    offset.push_back(start.size());
  }
  for (const Achieved &bar : achieved)
    got_start.push_back(bar.start), got_end.push_back(bar.end), state.push_back(bar.state);
  const std::size_t count = start.size();
  put(doc, "/cells/type", std::vector<std::uint32_t>{0, 0, 2});
  put_texts(doc, "/types/entry", {"L23_pyramidal", "", "astrocyte"});
  put(doc, "/bars/cell_offset", offset), put(doc, "/bars/tree", std::vector<std::uint32_t>(count));
  put(doc, "/bars/parent", parent), put(doc, "/bars/neurite", std::vector<std::uint8_t>(count, 3));
  put(doc, "/bars/asked_start", start), put(doc, "/bars/asked_end", end);
  put(doc, "/bars/achieved_start", got_start), put(doc, "/bars/achieved_end", got_end);
  put3(doc, "/bars/attractor", std::vector<glm::dvec3>(count, {0, 0, 0})), put(doc, "/bars/angle", angle);
  put(doc, "/bars/radius", std::vector<double>(count, 0.5)),
      put(doc, "/bars/taper", std::vector<double>(count));
  put(doc, "/bars/radius_floor", std::vector<double>(count, 0.1)), put(doc, "/bars/state", state);
}

} // namespace barcodes
