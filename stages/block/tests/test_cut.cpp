// SPDX-License-Identifier: BSD-3-Clause
// What a block takes of a cell: sections from their beginnings, joined as in the cell; images through a
// periodic side; and the stage as the host runs it, on a document.
#include "../cut.hpp"

#include "check.h"
#include "conceg/geom.h"
#include "conceg/run.h"
#include "view.hpp"

#include <algorithm>
#include <set>
#include <string>

using namespace conceg;
using namespace conceg::block;

extern "C" const conceg_stage conceg_stage_block;

namespace {

// One cell: soma of 5 um at z = 10; a trunk up to a fork at 40, and from there two daughters up to 80; a
// second root down to -10. Branches 0 (trunk), 1, 2 (daughters), 3 (down). A point every 2 um.
Tissue cell() {
  Tissue t;
  t.soma = {{1, 2, 10}};
  t.soma_radius = {5};
  const auto add = [&](double x, double z, std::int64_t parent, std::uint32_t branch) {
    t.position.push_back({x, 2, z}), t.radius.push_back(0.5f), t.parent.push_back(parent),
        t.branch.push_back(branch);
    return static_cast<std::int64_t>(t.position.size()) - 1;
  };
  std::int64_t at = -1;
  for (double z = 15; z <= 40; z += 2.5)
    at = add(1, z, at, 0);
  const std::int64_t fork = at;
  for (std::uint32_t daughter = 1; daughter <= 2; daughter++) {
    at = fork;
    for (double z = 42; z <= 80; z += 2)
      at = add(1 + (daughter == 1 ? 1 : -1) * (z - 40), z, at, daughter);
  }
  at = -1;
  for (double z = 5; z >= -10; z -= 2.5)
    at = add(1, z, at, 3);
  t.offset = {0, t.position.size()};
  return t;
}

std::set<std::uint32_t> branches(const Tissue &t, const Piece &piece) {
  std::set<std::uint32_t> out;
  for (const std::uint32_t row : piece.rows)
    out.insert(t.branch[row]);
  return out;
}

void whole_sections() {
  const Tissue t = cell();
  std::vector<Piece> p = cut(t, {-1000, 1000, 0, 0});
  CHECK_EQUAL(p.size(), 1);
  CHECK(p[0].has_soma && p[0].rows.size() == t.position.size());
  // Above the fork: two daughters, whole, joined in the point of the fork, without soma.
  p = cut(t, {60, 70, 1, 0});
  CHECK_EQUAL(p.size(), 1);
  CHECK(!p[0].has_soma);
  CHECK_EQUAL(p[0].rows.size(),
              1 + 16 + 16);      // from 42 up to 72, whose segment begins within 1.5 um of the block
  CHECK_EQUAL(p[0].rows[0], 10); // the fork, the last point of the trunk
  CHECK((branches(t, p[0]) == std::set<std::uint32_t>{0, 1, 2}));
  // Below the soma: the lower root alone, and it is a root.
  p = cut(t, {-8, -4, 0.1, 0});
  CHECK_EQUAL(p.size(), 1);
  CHECK(!p[0].has_soma && t.parent[p[0].rows[0]] == -1);
  CHECK((branches(t, p[0]) == std::set<std::uint32_t>{3}));
  // Through the soma: both roots hang on it, the daughters are left out.
  p = cut(t, {8, 12, 0, 0});
  CHECK_EQUAL(p.size(), 1);
  CHECK(p[0].has_soma);
  CHECK((branches(t, p[0]) == std::set<std::uint32_t>{}));
  p = cut(t, {8, 16, 0, 0});
  CHECK((branches(t, p[0]) == std::set<std::uint32_t>{0}));
  // The margin counts, and so does the radius: the top is at 80.5.
  CHECK_EQUAL(cut(t, {81.4, 90, 1, 0}).size(), 1);
  CHECK_EQUAL(cut(t, {81.6, 90, 1, 0}).size(), 0);
  // Rows ascend, so that parents come first.
  for (const Piece &piece : cut(t, {30, 50, 0, 0}))
    CHECK(std::is_sorted(piece.rows.begin(), piece.rows.end()));
}

// In a tissue of 50 um along z the cell reaches from -10.5 to 80.5: a block sees images of it.
void images() {
  const Tissue t = cell();
  const std::vector<Piece> p = cut(t, {44, 48, 0, 50});
  // Itself: the daughters; the image above: its lower root at 40 to 55 and, as the soma reaches down to 55,
  // not the soma.
  CHECK_EQUAL(p.size(), 2);
  CHECK(p[0].lift == 0 && !p[0].has_soma && branches(t, p[0]).count(1));
  CHECK(p[1].lift == 1 && !p[1].has_soma && (branches(t, p[1]) == std::set<std::uint32_t>{3}));
  CHECK(cut(t, {56, 57, 0, 50})[1].has_soma);
}

conceg_doc *document(conceg_ctx *ctx, const Tissue &t) {
  conceg_doc *doc = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  const double lo[3] = {0, 0, -20}, hi[3] = {40, 40, 100}, pia[3] = {0, 0, 1};
  const std::uint8_t periodic[3] = {1, 1, 0};
  put(doc, "/domain@lo", lo, 3), put(doc, "/domain@hi", hi, 3), put(doc, "/domain@periodic", periodic, 3);
  put(doc, "/domain@pia", pia, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
  put_texts(doc, "/types/name", {"cell"}), put_texts(doc, "/types/class", {"pyramidal"});
  put(doc, "/cells/id", std::vector<std::uint64_t>{7});
  put(doc, "/cells/type", std::vector<std::uint32_t>{0});
  put3(doc, "/cells/soma", t.soma), put(doc, "/cells/radius", t.soma_radius);
  put(doc, "/skeleton/cell_offset", t.offset);
  put3(doc, "/skeleton/position", t.position);
  put(doc, "/skeleton/radius", t.radius), put(doc, "/skeleton/target_radius", t.radius);
  put(doc, "/skeleton/parent", t.parent);
  put(doc, "/skeleton/kind", std::vector<std::uint8_t>(t.position.size(), 3));
  put(doc, "/skeleton/branch", t.branch);
  return doc;
}

conceg_status run(conceg_ctx *ctx, conceg_doc *doc, std::vector<const char *> sets) {
  conceg_params *params = nullptr;
  sets.push_back(nullptr);
  conceg_status status =
      conceg_params_new(ctx, &conceg_stage_block, doc, nullptr, sets.data(), nullptr, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_block, doc, params);
  conceg_params_free(params);
  return status;
}

void as_a_stage() {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, nullptr, nullptr);
  conceg_doc *doc = document(ctx, cell());
  CHECK_EQUAL(run(ctx, doc, {"block.lo_um=60", "block.hi_um=70"}), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
  CHECK_NEAR(view<double>(doc, "/domain@lo", 3)[2], 60, 0);
  CHECK_NEAR(view<double>(doc, "/domain@hi", 3)[2], 70, 0);
  CHECK_EQUAL(view<std::uint64_t>(doc, "/cells/id")[0], 7 + (std::uint64_t{1} << 40));
  CHECK_NEAR(static_cast<double>(view<float>(doc, "/cells/radius")[0]), 0, 0);
  const auto soma = view<double>(doc, "/cells/soma", 3), place = view<double>(doc, "/skeleton/position", 3);
  CHECK_NEAR(soma[2], 60, 0); // the first point inside
  CHECK_NEAR(soma[0], 21, 0);
  CHECK_NEAR(place.row(0)[2], 40, 0);
  const auto parent = view<std::int64_t>(doc, "/skeleton/parent");
  CHECK(parent[0] == -1 && parent[1] == 0 && parent[18] == 0 && parent[19] == 18);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  // The whole box: the cell as it was.
  doc = document(ctx, cell());
  CHECK_EQUAL(run(ctx, doc, {}), CONCEG_OK);
  CHECK_EQUAL(view<std::uint64_t>(doc, "/cells/id")[0], 7);
  CHECK_EQUAL(view<double>(doc, "/skeleton/position", 3).rows(), cell().position.size());
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = document(ctx, cell());
  CHECK_EQUAL(run(ctx, doc, {"block.lo_um=50", "block.hi_um=40"}), CONCEG_E_RANGE);
  CHECK(std::string(conceg_ctx_error(ctx)).find("from -20 to 100 um along z, got 50 to 40") !=
        std::string::npos);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = document(ctx, cell());
  CHECK_EQUAL(run(ctx, doc, {"block.lo_um=90"}), CONCEG_E_RANGE);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
}

} // namespace

int main() {
  whole_sections();
  images();
  as_a_stage();
  return check_done();
}
