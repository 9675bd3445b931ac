// SPDX-License-Identifier: BSD-3-Clause
// Runs the place stage as the host does, on a recipe of 80 um with 102 cells, and tells which trees of the
// dictionary its cells were given.
#pragma once

#include "check.h"
#include "conceg/run.h"
#include "view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

extern "C" const conceg_stage conceg_stage_place;
using namespace conceg;

static conceg_ctx *ctx; // of the whole test program

// A recipe of 80 um with all pyramidal entries; `more` goes on top.
inline std::string recipe_text(const char *more) {
  return std::string("conceg: 1\nseed: 3\ndomain: {size_um: [80, 80, 80.000001], periodic: [true, true, "
                     "true]}\ndensity_per_um3: 2e-4\n"
                     "types:\n"
                     "  - {name: a, class: pyramidal, entry: L23_pyramidal, fraction: 0.2, radius_scale: 2}\n"
                     "  - {name: b, class: pyramidal, entry: L4_pyramidal, fraction: 0.3}\n"
                     "  - {name: c, class: pyramidal, entry: L5_pyramidal, fraction: 0.3}\n"
                     "  - {name: d, class: astrocyte, entry: astrocyte, fraction: 0.2}\n") +
         more;
}

inline conceg_doc *run(const std::string &text, std::vector<const char *> sets = {}) {
  conceg_doc *doc = nullptr;
  conceg_recipe *recipe = nullptr;
  conceg_params *params = nullptr;
  sets.push_back(nullptr);
  conceg_ctx_clear_error(ctx);
  conceg_status status = conceg_doc_new(ctx, &doc);
  if (status == CONCEG_OK) status = conceg_recipe_parse(ctx, text.c_str(), "test.yaml", &recipe);
  if (status == CONCEG_OK)
    status = conceg_params_new(ctx, &conceg_stage_place, doc, recipe, sets.data(), nullptr, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_place, doc, params);
  conceg_params_free(params);
  conceg_recipe_free(recipe);
  if (status == CONCEG_OK) return doc;
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  return nullptr;
}

inline std::string digest(conceg_doc *doc, const char *group = "/") {
  char hex[65] = "";
  if (doc) CHECK_EQUAL(conceg_doc_digest(doc, group, hex), CONCEG_OK);
  return hex;
}

// A tree is known by its neurite kind and by its bars: start, end, and distance of the tip in nm, which a
// rotation leaves alone. Donors that were made of the same barcodes differ in the last one only.
using Tree = std::pair<std::uint8_t, std::vector<std::tuple<double, double, long long>>>;

struct Tissue {
  std::vector<std::uint32_t> donor;                     // of each cell
  std::vector<std::vector<Tree>> trees;                 // of each cell
  std::vector<std::array<int, 8>> trees_of_kind;        // of each donor, by SWC code, axons left out
  std::vector<std::uint8_t> fold;                       // of each donor
  std::map<Tree, std::vector<std::uint32_t>> donors_of; // a tree of the dictionary -> whose it is
};

inline Tissue tissue_of(conceg_doc *doc) {
  Tissue out;
  const auto donor = view<std::uint32_t>(doc, "/cells/donor"), tree = view<std::uint32_t>(doc, "/bars/tree");
  const auto cell_offset = view<std::uint64_t>(doc, "/bars/cell_offset");
  const auto neurite = view<std::uint8_t>(doc, "/bars/neurite");
  const auto start = view<double>(doc, "/bars/asked_start"), end = view<double>(doc, "/bars/asked_end");
  const auto soma = view<double>(doc, "/cells/soma", 3), attractor = view<double>(doc, "/bars/attractor", 3);
  for (std::size_t cell = 0; cell < donor.rows(); cell++) {
    std::vector<Tree> trees;
    for (std::uint64_t bar = cell_offset[cell]; bar < cell_offset[cell + 1]; bar++) {
      if (tree[bar] == trees.size()) trees.push_back({neurite[bar], {}});
      double square = 0.0;
      for (int axis = 0; axis < 3; axis++)
        square += std::pow(attractor.row(bar)[axis] - soma.row(cell)[axis], 2);
      trees[tree[bar]].second.emplace_back(start[bar], end[bar], std::llround(1000.0 * std::sqrt(square)));
    }
    for (Tree &one : trees)
      std::sort(one.second.begin(), one.second.end());
    out.donor.push_back(donor[cell]);
    out.trees.push_back(trees);
  }
  const auto tree_offset = view<std::uint64_t>(doc, "/dictionary/donor_tree_offset"),
             bar_offset = view<std::uint64_t>(doc, "/dictionary/tree_bar_offset");
  const auto kind = view<std::uint8_t>(doc, "/dictionary/tree_neurite");
  const auto birth = view<double>(doc, "/dictionary/bar_birth"),
             death = view<double>(doc, "/dictionary/bar_death"),
             distance = view<double>(doc, "/dictionary/bar_tip_distance");
  for (std::uint32_t d = 0; d + 1 < tree_offset.rows(); d++) {
    std::array<int, 8> count = {};
    for (std::uint64_t t = tree_offset[d]; t < tree_offset[d + 1]; t++) {
      Tree one = {kind[t], {}};
      for (std::uint64_t bar = bar_offset[t]; bar < bar_offset[t + 1]; bar++)
        one.second.emplace_back(birth[bar], death[bar], std::llround(1000.0 * distance[bar]));
      std::sort(one.second.begin(), one.second.end());
      out.donors_of[one].push_back(d);
      count[kind[t]] += kind[t] != 2;
    }
    out.trees_of_kind.push_back(count);
  }
  const auto fold = view<std::uint8_t>(doc, "/dictionary/donor_fold");
  out.fold.assign(fold.begin(), fold.end());
  return out;
}
