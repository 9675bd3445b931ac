// SPDX-License-Identifier: BSD-3-Clause
// Donors that are held back: no cell has their soma, their trees or their angles, the document keeps and
// marks them, and an entry without other donors ends in one clear line. The default run, which knows no fold,
// fails the same checks.
#include "run_place.hpp"

#include <set>

static std::string warnings;
static void keep_warning(void *, conceg_log_level level, const char *line) {
  if (level == CONCEG_LOG_WARNING) warnings += std::string(line) + "\n";
}

// Cells and trees that a donor of the fold was drawn for.
struct Leaks {
  int cells = 0, trees = 0;
};
static Leaks leaks_of(const Tissue &tissue, int fold) {
  Leaks leaks;
  for (std::size_t cell = 0; cell < tissue.donor.size(); cell++) {
    leaks.cells += tissue.fold[tissue.donor[cell]] == fold;
    for (const Tree &tree : tissue.trees[cell])
      for (const std::uint32_t donor : tissue.donors_of.at(tree))
        leaks.trees += tissue.fold[donor] == fold;
  }
  return leaks;
}

static void test_folds() {
  for (const char *trees : {"place.trees=donor", "place.trees=independent"}) {
    conceg_doc *all = run(recipe_text(""), {trees});
    CHECK(all != nullptr);
    if (!all) continue;
    CHECK(!has(all, "/dictionary/donor_validation"));
    const Tissue whole = tissue_of(all);
    for (int fold = 0; fold < 5; fold++) {
      const std::string set = "place.validation_fold=" + std::to_string(fold);
      warnings.clear();
      conceg_doc *doc = run(recipe_text(""), {trees, set.c_str()});
      CHECK(doc != nullptr);
      if (!doc) {
        std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
        continue;
      }
      CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
      const Tissue tissue = tissue_of(doc);
      const Leaks held = leaks_of(tissue, fold), ignored = leaks_of(whole, fold);
      CHECK_EQUAL(held.cells, 0);
      CHECK_EQUAL(held.trees, 0);
      CHECK(ignored.cells > 5 && ignored.trees > 20); // what a run that ignores the fold would show
      CHECK(tissue.fold == whole.fold);               // the donors are all still there
      const auto mark = view<std::uint8_t>(doc, "/dictionary/donor_validation");
      CHECK_EQUAL(mark.rows(), whole.fold.size());
      for (std::size_t donor = 0; donor < mark.rows(); donor++)
        CHECK_EQUAL(mark[donor], whole.fold[donor] == fold);
      // Layer 2/3 has four donors, of the folds 0 to 3.
      CHECK((warnings.find("entry L23_pyramidal has no donor of fold 4") != std::string::npos) ==
            (fold == 4));
      CHECK(warnings.find("L4_pyramidal") == std::string::npos);
      CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
    }
    CHECK_EQUAL(conceg_doc_close(all), CONCEG_OK);
  }
}

// Drawn fork angles that no donor has but those of fold 1.
static int angles_of_fold(conceg_doc *doc) {
  const auto fold = view<std::uint8_t>(doc, "/dictionary/donor_fold");
  const auto donor_tree = view<std::uint64_t>(doc, "/dictionary/donor_tree_offset"),
             tree_bar = view<std::uint64_t>(doc, "/dictionary/tree_bar_offset");
  const auto own = view<double>(doc, "/dictionary/bar_angle"), drawn = view<double>(doc, "/bars/angle");
  const auto parent = view<std::int64_t>(doc, "/bars/parent");
  std::set<double> others, held;
  for (std::size_t donor = 0; donor < fold.rows(); donor++)
    for (std::uint64_t bar = tree_bar[donor_tree[donor]]; bar < tree_bar[donor_tree[donor + 1]]; bar++)
      (fold[donor] == 1 ? held : others).insert(own[bar]);
  int found = 0;
  for (std::size_t bar = 0; bar < drawn.rows(); bar++)
    found += parent[bar] != -1 && held.count(drawn[bar]) && !others.count(drawn[bar]);
  return found;
}

static void test_angles() {
  conceg_doc *all = run(recipe_text(""), {"place.angles=drawn"}),
             *held = run(recipe_text(""), {"place.angles=drawn", "place.validation_fold=1"});
  CHECK(all && held);
  if (all && held) {
    CHECK_EQUAL(angles_of_fold(held), 0);
    CHECK(angles_of_fold(all) > 100);
  }
  CHECK_EQUAL(conceg_doc_close(all), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(held), CONCEG_OK);
}

// Saves a document whose dictionary has these folds (none = no array of them), and runs on it.
static conceg_doc *run_on(const std::vector<std::uint8_t> &folds, const char *set) {
  const char *path = "test_place_folds.cgx";
  conceg_doc *doc = run(recipe_text(""), {"place.validation_fold=0"}), *out = nullptr;
  CHECK(doc != nullptr);
  if (!doc) return nullptr;
  if (folds.empty()) CHECK_EQUAL(conceg_doc_drop(doc, "/dictionary/donor_fold"), CONCEG_OK);
  if (!folds.empty()) put(doc, "/dictionary/donor_fold", folds);
  CHECK_EQUAL(conceg_doc_save(doc, path), CONCEG_OK);
  out = run(recipe_text(""), {"dictionary=test_place_folds.cgx", set});
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  std::remove(path);
  return out;
}

static void refused(conceg_doc *doc, const char *expected) {
  const std::string line = conceg_ctx_error(ctx);
  CHECK(doc == nullptr);
  CHECK(line.find(expected) != std::string::npos && line.find('\n') == std::string::npos);
  if (line.find(expected) == std::string::npos)
    std::fprintf(stderr, "expected \"%s\" in \"%s\"\n", expected, line.c_str());
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

static void test_refusals() {
  conceg_doc *doc = run(recipe_text(""));
  CHECK(doc != nullptr);
  if (!doc) return;
  const auto fold = view<std::uint8_t>(doc, "/dictionary/donor_fold");
  const auto offset = view<std::uint64_t>(doc, "/dictionary/entry_donor_offset");
  const std::vector<std::uint8_t> as_made(fold.begin(), fold.end());
  std::vector<std::uint8_t> planted = as_made;
  std::fill(planted.begin() + static_cast<std::ptrdiff_t>(offset[2]),
            planted.begin() + static_cast<std::ptrdiff_t>(offset[3]), std::uint8_t{3});
  refused(run_on(planted, "place.validation_fold=3"),
          "donors beside those of fold 3 in dictionary entry L5_pyramidal, got none; choose another fold, or "
          "-1 to hold back none");
  refused(run_on({}, "place.validation_fold=0"), "expected /dictionary/donor_fold in the dictionary");
  refused(run(recipe_text(""), {"place.validation_fold=5"}), "validation_fold");
  // The marks of the document that the dictionary is taken from are not those of the new one.
  conceg_doc *again = run_on(as_made, "place.validation_fold=-1");
  CHECK(again != nullptr);
  if (again) {
    CHECK(!has(again, "/dictionary/donor_validation"));
    CHECK(digest(again, "/bars") == digest(doc, "/bars"));
  }
  CHECK_EQUAL(conceg_doc_close(again), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

int main() {
  ctx = conceg_ctx_new();
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, keep_warning, nullptr);
  test_folds();
  test_angles();
  test_refusals();
  conceg_ctx_free(ctx);
  return check_done();
}
