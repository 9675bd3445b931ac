// SPDX-License-Identifier: BSD-3-Clause
// Cells whose trees are drawn independently: as many of each kind as the donor has, each of the entry's trees
// as likely as the others, donors mixed, frames of unknown donors spun, the other draws and the threads
// without effect.
#include "../donors.hpp"
#include "run_place.hpp"

#include "conceg/rng.h"

#include <glm/geometric.hpp>

#include <functional>
#include <set>

using namespace conceg::place;

static const int cells = 20000;

// Entry 0: two donors of known frame and one of unknown frame; one tree of the second has no bars. Entry 1:
// one more donor. Every tree has one bar straight up, or none.
//   row of the tree   0 1 2 3 | 4 5 6 7 | 8 9 10 | 11
//   neurite           3 2 3 4 | 3 3 3 2 | 3 4 2  | 3      (6 is the one without bars)
static Dictionary example() {
  Dictionary d;
  d.entry.name = {"mixed", "other"};
  d.entry.class_name = {"pyramidal", "pyramidal"};
  d.entry.donor_offset = {0, 3, 4};
  d.entry.angle_offset = {0, 0, 0};
  d.donor.id = {"a", "b", "c", "d"};
  d.donor.frame_kind = {"apical", "axis", "unknown", "apical"};
  d.donor.soma_radius = {7, 7, 7, 7};
  d.donor.tree_offset = {0, 4, 8, 11, 12};
  d.tree.neurite = {3, 2, 3, 4, 3, 3, 3, 2, 3, 4, 2, 3};
  d.tree.trunk_direction.assign(12, {0, 0, 1});
  d.tree.bar_offset = {0};
  for (std::uint64_t tree = 0; tree < 12; tree++)
    d.tree.bar_offset.push_back(d.tree.bar_offset.back() + (tree != 6));
  d.bar.parent.assign(11, -1);
  d.bar.birth.assign(11, 0.0), d.bar.death.assign(11, 100.0), d.bar.tip_distance.assign(11, 100.0);
  d.bar.radius.assign(11, 0.5), d.bar.taper.assign(11, 0.0), d.bar.angle.assign(11, 0.0);
  d.bar.tip_direction.assign(11, {0, 0, 1});
  return d;
}

static std::vector<TreeDraw> draw(const Dictionary &d, std::size_t donor, int id,
                                  const DonorOptions &options) {
  const auto cell = static_cast<std::uint64_t>(id);
  return draw_trees(d, pool_of(d, 0), {cell, donor, draw_rotation(d, donor, cell, options), {}, 1.0},
                    options);
}

static std::vector<std::size_t> rows_of(const std::vector<TreeDraw> &trees) {
  std::vector<std::size_t> rows;
  for (const TreeDraw &tree : trees)
    rows.push_back(tree.tree);
  return rows;
}

static double chi_square(const std::vector<int> &counts) {
  double sum = 0.0, square = 0.0;
  for (const int count : counts)
    sum += count;
  const double expected = sum / static_cast<double>(counts.size());
  for (const int count : counts)
    square += (count - expected) * (count - expected) / expected;
  return square;
}

static void test_kinds() {
  const Dictionary d = example();
  DonorOptions options;
  CHECK(rows_of(draw(d, 0, 1, options)) == (std::vector<std::size_t>{0, 2, 3})); // not the axon
  CHECK(rows_of(draw(d, 1, 1, options)) == (std::vector<std::size_t>{4, 5}));    // not the tree without bars
  options.independent_trees = true;
  for (int id = 0; id < 200; id++) {
    options.axons = false;
    const std::vector<std::size_t> a = rows_of(draw(d, 0, id, options)), b = rows_of(draw(d, 1, id, options));
    CHECK_EQUAL(a.size(), 3);
    CHECK_EQUAL(b.size(), 2);
    CHECK(d.tree.neurite[a[0]] == 3 && d.tree.neurite[a[1]] == 3 && d.tree.neurite[a[2]] == 4);
    CHECK(d.tree.neurite[b[0]] == 3 && d.tree.neurite[b[1]] == 3);
    // The axon comes between the others and changes none of them.
    options.axons = true;
    std::vector<std::size_t> with = rows_of(draw(d, 0, id, options));
    CHECK_EQUAL(with.size(), 4);
    CHECK(d.tree.neurite[with[1]] == 2);
    with.erase(with.begin() + 1);
    CHECK(with == a);
  }
}

// Basal trees 0 2 4 5 8, two for each cell of donor a: all 25 pairs are alike. `second` draws them.
static double pairs(const std::function<std::vector<std::size_t>(int)> &second) {
  static const int place_of[12] = {0, -1, 1, -1, 2, 3, -1, -1, 4, -1, -1, -1};
  std::vector<int> counts(25);
  for (int id = 0; id < cells; id++) {
    const std::vector<std::size_t> rows = second(id);
    const int one = place_of[rows[0]], two = place_of[rows[1]];
    CHECK(one >= 0 && two >= 0); // a tree of the entry, of the kind, with bars
    if (one >= 0 && two >= 0) counts[static_cast<std::size_t>(5 * one + two)]++;
  }
  return chi_square(counts);
}

static void test_uniform() {
  const Dictionary d = example();
  DonorOptions options;
  options.independent_trees = true;
  const double limit = 24 + 5 * std::sqrt(2.0 * 24); // mean and 5 sd of 24 degrees of freedom
  const double found = pairs([&](int id) { return rows_of(draw(d, 0, id, options)); });
  CHECK(found < limit);
  // A draw of the donor first and then of one of its trees is not uniform, and two trees of the same donor
  // are not independent: both are seen.
  const std::vector<std::vector<std::size_t>> of_donor = {{0, 2}, {4, 5}, {8}};
  const auto pick = [](conceg_rng &rng, const std::vector<std::size_t> &from) {
    return from[conceg_rng_below(&rng, from.size())];
  };
  const double donor_first = pairs([&](int id) {
    conceg_rng rng = conceg_rng_stream(1, "planted", static_cast<std::uint64_t>(id));
    const auto draw_one = [&] { return pick(rng, of_donor[conceg_rng_below(&rng, 3)]); };
    const std::size_t one = draw_one();
    return std::vector<std::size_t>{one, draw_one()};
  });
  const double same_donor = pairs([&](int id) {
    conceg_rng rng = conceg_rng_stream(1, "planted", static_cast<std::uint64_t>(id));
    const std::size_t first = pick(rng, {0, 2, 4, 5, 8});
    return std::vector<std::size_t>{first, pick(rng, of_donor[first / 4])};
  });
  std::printf("chi square of pairs: %.1f, limit %.1f; planted: donor first %.0f, one donor %.0f\n", found,
              limit, donor_first, same_donor);
  CHECK(donor_first > limit);
  CHECK(same_donor > limit);
}

// A tree of known frame turns with the cell; one of unknown frame points everywhere, alone.
static void test_frames() {
  const Dictionary d = example();
  DonorOptions options;
  options.independent_trees = true;
  glm::dvec3 mean(0), square(0), turned(0);
  int spun = 0, pair = 0;
  double together = 0.0;
  for (int id = 0; id < cells; id++) {
    const glm::dquat cell = draw_rotation(d, 0, static_cast<std::uint64_t>(id), options);
    std::vector<glm::dvec3> unknown;
    for (const TreeDraw &tree : draw(d, 0, id, options)) {
      const glm::dvec3 up = tree.rotation * glm::dvec3(0, 0, 1);
      if (tree.tree < 8) {
        CHECK(tree.rotation == cell);
        continue;
      }
      unknown.push_back(up);
      mean += up, square += up * up, spun++;
    }
    if (unknown.size() > 1) together += glm::dot(unknown[0], unknown[1]), pair++;
    // In a cell of unknown frame every tree points everywhere.
    turned += draw(d, 2, id, options)[0].rotation * glm::dvec3(0, 0, 1);
  }
  CHECK(spun > cells / 2 && pair > cells / 10);
  for (int axis = 0; axis < 3; axis++) {
    CHECK_NEAR(mean[axis] / spun, 0.0, 0.02); // 4 sd or more, all three
    CHECK_NEAR(square[axis] / spun, 1.0 / 3.0, 0.01);
    CHECK_NEAR(turned[axis] / cells, 0.0, 0.02);
  }
  CHECK_NEAR(together / pair, 0.0, 0.04);
}

// On the embedded dictionary. /cells, and so soma and donor, are those of the default.
static void test_tissue() {
  conceg_ctx_set_threads(ctx, 1);
  conceg_doc *plain = run(recipe_text("")), *given = run(recipe_text(""), {"place.trees=donor"}),
             *mixed = run(recipe_text(""), {"place.trees=independent"});
  conceg_ctx_set_threads(ctx, 4);
  conceg_doc *threads = run(recipe_text(""), {"place.trees=independent"});
  CHECK(plain && given && mixed && threads);
  if (!plain || !given || !mixed || !threads) {
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    return;
  }
  CHECK_EQUAL(conceg_doc_validate(mixed, nullptr, nullptr, nullptr), CONCEG_OK);
  CHECK(digest(plain, "/bars") == digest(given, "/bars"));
  CHECK(digest(plain, "/bars") != digest(mixed, "/bars"));
  CHECK(digest(plain, "/cells") == digest(mixed, "/cells"));
  CHECK(digest(plain, "/dictionary") == digest(mixed, "/dictionary"));
  CHECK(digest(mixed) == digest(threads));

  int several[2] = {0, 0}, more_than_one_tree = 0;
  for (const bool independent : {false, true}) {
    const Tissue tissue = tissue_of(independent ? mixed : plain);
    CHECK(tissue.trees.size() > 50);
    for (std::size_t cell = 0; cell < tissue.trees.size(); cell++) {
      std::array<int, 8> count = {};
      std::set<std::uint32_t> donors;
      for (const Tree &tree : tissue.trees[cell]) {
        count[tree.first]++;
        const auto known = tissue.donors_of.find(tree);
        CHECK(known != tissue.donors_of.end());
        if (known == tissue.donors_of.end()) continue;
        CHECK_EQUAL(known->second.size(), 1); // trees can be told apart
        donors.insert(known->second[0]);
      }
      CHECK(count == tissue.trees_of_kind[tissue.donor[cell]]);
      several[independent] += donors.size() > 1;
      more_than_one_tree += independent && tissue.trees[cell].size() > 1;
    }
  }
  std::printf("cells with trees of several donors: %d by default, %d of %d when independent\n", several[0],
              several[1], more_than_one_tree);
  CHECK_EQUAL(several[0], 0);
  CHECK(10 * several[1] > 8 * more_than_one_tree);
  for (conceg_doc *doc : {plain, given, mixed, threads})
    CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

int main() {
  ctx = conceg_ctx_new();
  test_kinds();
  test_uniform();
  test_frames();
  test_tissue();
  conceg_ctx_free(ctx);
  return check_done();
}
