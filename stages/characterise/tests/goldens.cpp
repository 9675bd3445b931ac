// SPDX-License-Identifier: BSD-3-Clause
// Barcodes, sections and angles of real cells against figures made with NeuroM and TMD
// (CONCEG_SHARED/goldens).
#include "golden.hpp"

#include "sections.hpp"
#include "tests/trees.hpp"

#include <algorithm>
#include <array>

using namespace conceg;
using namespace conceg::characterise;
using golden::Json;

namespace {

using Barcode = std::vector<std::array<double, 2>>; // {death, birth}

void check_barcodes(const std::vector<Tree> &trees, const Json &figures) {
  std::vector<Barcode> ours, theirs;
  for (const Tree &tree : trees) {
    ours.emplace_back();
    for (const Bar &bar : find_bars(tree))
      ours.back().push_back({bar.death, bar.birth});
  }
  for (const Json &tree : figures.at("trees").items) {
    theirs.emplace_back();
    for (const Json &bar : tree.at("bars").items)
      theirs.back().push_back({bar.items[0].number, bar.items[1].number});
  }
  for (auto *side : {&ours, &theirs}) {
    for (Barcode &barcode : *side)
      std::sort(barcode.rbegin(), barcode.rend());
    std::sort(side->begin(), side->end(), [](const Barcode &a, const Barcode &b) {
      return a.size() != b.size() ? a.size() > b.size() : a[0] > b[0];
    });
  }
  CHECK_EQUAL(ours.size(), theirs.size());
  for (std::size_t t = 0; t < std::min(ours.size(), theirs.size()); t++) {
    CHECK_EQUAL(ours[t].size(), theirs[t].size());
    for (std::size_t b = 0; b < std::min(ours[t].size(), theirs[t].size()); b++) {
      CHECK_NEAR(ours[t][b][0], theirs[t][b][0], 2e-3);
      CHECK_NEAR(ours[t][b][1], theirs[t][b][1], 2e-3);
    }
  }
}

void check_figures(const std::vector<Tree> &trees, const Json &figures) {
  double sections = 0.0, length = 0.0, order = 0.0, angle = 0.0, tau = 0.0;
  std::size_t forks = 0;
  for (const Tree &tree : trees) {
    for (const Section &s : find_sections(tree)) {
      const double chord = glm::length(tree.position[s.nodes.back()] - tree.position[s.nodes.front()]);
      sections++, length += s.length, order += s.order - 1, tau += s.length > 0.0 ? chord / s.length : 1.0;
    }
    for (double a : fork_angles(tree))
      angle += a, forks++;
  }
  CHECK_NEAR(sections, figures.at("number_of_sections").number, 0);
  CHECK_NEAR(length, figures.at("total_length").number, 1e-6 * length);
  CHECK_NEAR(order / sections, figures.at("branch_order_mean").number, 1e-9);
  CHECK_NEAR(tau / sections, figures.at("tau_mean").number, 1e-5);
  CHECK_NEAR(angle / static_cast<double>(forks) * 57.29577951308232, figures.at("local_angle_mean").number,
             1e-3);
}

} // namespace

int main() {
  const Json figures = golden::load();
  conceg_ctx *ctx = conceg_ctx_new();
  CHECK(figures.at("cells").members.size() >= 7);
  for (const auto &[name, cell] : figures.at("cells").members) {
    const int failed = check_failed_;
    conceg_swc *swc = nullptr;
    CHECK_EQUAL(conceg_swc_read(ctx, (golden::folder() + cell.at("file").text).c_str(), 0, &swc), CONCEG_OK);
    const std::vector<Tree> trees = whole_trees(swc);
    check_barcodes(trees, cell.at("path_barcode"));
    check_figures(trees, cell.at("ref64_all"));
    if (failed != check_failed_) fprintf(stderr, "  in %s\n", name.c_str());
    conceg_swc_free(swc);
  }
  conceg_ctx_free(ctx);
  return check_done();
}
