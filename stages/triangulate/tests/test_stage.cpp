// SPDX-License-Identifier: GPL-3.0-or-later
// The triangulate stage as the host runs it: a valid network, the same bytes for any threads and tiles, work
// shared among workers, and one clear line for each wrong document.
#include "check.h"
#include "conceg/run.h"
#include "view.hpp"

#include <functional>
#include <string>
#include <vector>

extern "C" const conceg_stage conceg_stage_triangulate;
using namespace conceg;

// A box of 16 um, one soma of 4 um and one bar of at most 0.9 um.
static void write_tissue(conceg_doc *doc) {
  const double lo[3] = {-8, -8, -8}, hi[3] = {8, 8, 8}, pia[3] = {0, 0, 1};
  const std::uint8_t periodic[3] = {1, 1, 1};
  put(doc, "/domain@lo", lo, 3);
  put(doc, "/domain@hi", hi, 3);
  put(doc, "/domain@periodic", periodic, 3);
  put(doc, "/domain@pia", pia, 3);
  put_scalar<double>(doc, "/domain@lattice_step", 0x1p-16);
  put_texts(doc, "/types/name", {"a"});
  put_texts(doc, "/types/class", {"other"});
  put(doc, "/cells/id", std::vector<std::uint64_t>{0});
  put(doc, "/cells/type", std::vector<std::uint32_t>{0});
  put(doc, "/cells/soma", std::vector<double>{6, 0, 0}, 3);
  put(doc, "/cells/radius", std::vector<float>{4});
  put(doc, "/bars/cell_offset", std::vector<std::uint64_t>{0, 1});
  put(doc, "/bars/tree", std::vector<std::uint32_t>{0});
  put(doc, "/bars/parent", std::vector<std::int64_t>{-1});
  put(doc, "/bars/neurite", std::vector<std::uint8_t>{3});
  put(doc, "/bars/asked_start", std::vector<double>{0});
  put(doc, "/bars/asked_end", std::vector<double>{40});
  put(doc, "/bars/attractor", std::vector<double>{50, 0, 0}, 3);
  put(doc, "/bars/angle", std::vector<double>{0});
  put(doc, "/bars/radius", std::vector<double>{0.5});
  put(doc, "/bars/taper", std::vector<double>{-0.02});
  put(doc, "/bars/radius_floor", std::vector<double>{0.15});
  put(doc, "/bars/state", std::vector<std::uint8_t>{0});
}

// As many rows as nodes, and the radii of write_tissue().
static void check_radii(conceg_doc *doc) {
  const auto radius = view<float>(doc, "/network/radius");
  const auto position = view<double>(doc, "/network/position", 3);
  const auto offset = view<std::uint64_t>(doc, "/network/edge_offset");
  CHECK_EQUAL(radius.rows(), position.rows());
  CHECK_EQUAL(offset.rows(), position.rows() + 1);
  float largest = -100, smallest = 100;
  for (const float r : radius)
    largest = std::max(largest, r), smallest = std::min(smallest, r);
  CHECK_NEAR(static_cast<double>(largest), 1.0, 1e-6); // 0.5 + 0.02 * 20 and the margin of 0.1
  CHECK(smallest < -3.0f && smallest >= -4.0f);
}

// Runs the stage, after `change` was made to the document; "" and the network's digest, or the error line.
static std::string run(conceg_ctx *ctx, unsigned threads, std::vector<const char *> sets, std::string &digest,
                       const std::function<void(conceg_doc *)> &change,
                       const std::function<void(conceg_doc *)> &look = check_radii) {
  conceg_ctx_set_threads(ctx, threads);
  conceg_ctx_clear_error(ctx);
  sets.push_back(nullptr);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  conceg_status status = conceg_doc_new(ctx, &doc);
  if (status == CONCEG_OK) {
    write_tissue(doc);
    if (change) change(doc);
    status = conceg_params_new(ctx, &conceg_stage_triangulate, doc, nullptr, sets.data(), nullptr, &params);
  }
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_triangulate, doc, params);
  std::string line = status == CONCEG_OK ? "" : conceg_ctx_error(ctx);
  char hex[65] = "";
  if (status == CONCEG_OK) {
    CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
    CHECK_EQUAL(conceg_doc_digest(doc, "/network", hex), CONCEG_OK);
    look(doc);
  }
  digest = hex;
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  return line;
}

static std::string digest_of(conceg_ctx *ctx, unsigned threads, std::vector<const char *> sets) {
  std::string digest;
  CHECK(run(ctx, threads, std::move(sets), digest, {}).empty());
  return digest;
}

// The error line when `damage` was done to the document.
static void refused(conceg_ctx *ctx, const char *expected, const std::function<void(conceg_doc *)> &damage,
                    std::vector<const char *> sets = {}) {
  std::string digest;
  const std::string line = run(ctx, 1, std::move(sets), digest, damage);
  if (line.find(expected) == std::string::npos)
    std::fprintf(stderr, "expected \"%s\" in \"%s\"\n", expected, line.c_str());
  CHECK(line.find(expected) != std::string::npos);
}

static std::size_t node_count(conceg_ctx *ctx, std::vector<const char *> sets) {
  std::size_t count = 0;
  std::string digest;
  CHECK(run(ctx, 2, std::move(sets), digest, {}, [&](conceg_doc *doc) {
          count = view<double>(doc, "/network/position", 3).rows();
        }).empty());
  return count;
}

// Finer near the soma, and where the cell grows when its processes are thin for the spacing of 0.79 um and it
// is compact: its one bar has a radius of 0.5 um and an attractor 44 um from the soma.
static void test_graded(conceg_ctx *ctx) {
  const std::string graded = digest_of(ctx, 1, {"triangulate.nodes=graded"});
  CHECK(graded != digest_of(ctx, 1, {}));
  for (const char *tile : {"triangulate.tile_um=5", "triangulate.tile_um=9"})
    for (const unsigned threads : {1u, 2u})
      CHECK(graded == digest_of(ctx, threads, {"triangulate.nodes=graded", tile}));
  CHECK(digest_of(ctx, 1, {}) ==
        digest_of(ctx, 1, {"triangulate.nodes=graded", "triangulate.grade_levels=0"}));

  const std::size_t plain = node_count(ctx, {});
  CHECK_EQUAL(plain, 8192);
  const std::size_t near = node_count(ctx, {"triangulate.nodes=graded"});
  CHECK(near > 2 * plain && near < 6 * plain);
  CHECK(node_count(ctx, {"triangulate.nodes=graded", "triangulate.grade_distance_um=1"}) < near);
  CHECK_EQUAL(node_count(ctx, {"triangulate.nodes=graded", "triangulate.grade_territory_um=45"}), near);
  CHECK_EQUAL(node_count(ctx, {"triangulate.nodes=graded", "triangulate.grade_spacing_radii=1"}), near);
  const std::size_t thin = node_count(ctx, {"triangulate.nodes=graded", "triangulate.grade_territory_um=45",
                                            "triangulate.grade_spacing_radii=1"});
  CHECK(thin > 7 * plain && thin <= 8 * plain);
}

// The warnings of a run.
static std::string warnings_of(conceg_ctx *ctx, std::vector<const char *> sets,
                               const std::function<void(conceg_doc *)> &change = {}) {
  std::string lines, digest;
  conceg_ctx_set_log(
      ctx, CONCEG_LOG_WARNING,
      [](void *user, conceg_log_level, const char *line) { *static_cast<std::string *>(user) += line; },
      &lines);
  CHECK(run(ctx, 1, std::move(sets), digest, change, [](conceg_doc *) {}).empty());
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, nullptr, nullptr);
  return lines;
}

static void test_too_sparse(conceg_ctx *ctx) {
  const auto holds = [](const std::string &text, const char *part) {
    return text.find(part) != std::string::npos;
  };
  CHECK(warnings_of(ctx, {}).empty());
  const std::string sparse = warnings_of(ctx, {"triangulate.density_per_um3=0.05"}); // 2.7 um apart
  CHECK(holds(sparse, "edges of at most 2 um on average (the longest step of grow), got 3.26 um"));
  CHECK(holds(sparse, "than the thickest process is wide (1.8 um), got 2.71 um; ask for 0.17 um^-3 or more"));
  CHECK(warnings_of(ctx, {"triangulate.density_per_um3=0.22"}).empty());
  const std::string thin = warnings_of(ctx, {}, [](conceg_doc *doc) {
    put(doc, "/bars/radius", std::vector<double>{0.2});
    put(doc, "/bars/taper", std::vector<double>{0});
  });
  CHECK(holds(thin, "wide (0.4 um), got 0.794 um; ask for 16 um^-3 or more"));
  CHECK(!holds(thin, "longest step"));
}

int main() {
  conceg_ctx *ctx = conceg_ctx_new();
  test_graded(ctx);
  test_too_sparse(ctx);
  const std::string one = digest_of(ctx, 1, {});
  CHECK(!one.empty());
  for (const unsigned threads : {2u, 3u})
    CHECK(one == digest_of(ctx, threads, {}));
  CHECK(one == digest_of(ctx, 2, {"triangulate.tile_um=5"}));
  CHECK(one != digest_of(ctx, 1, {"seed=2"}));
  const std::string paper = digest_of(ctx, 1, {"triangulate.nodes=uniform", "triangulate.faces=mirrored"});
  CHECK(paper != one);
  CHECK(paper == digest_of(ctx, 3, {"triangulate.nodes=uniform", "triangulate.faces=mirrored"}));

  refused(ctx, "on the lattice", [](conceg_doc *doc) {
    const double hi[3] = {8, 8, 8.00001};
    put(doc, "/domain@hi", hi, 3);
  });
  refused(ctx, "/cells/radius", [](conceg_doc *doc) { put(doc, "/cells/radius", std::vector<float>{4, 4}); });
  refused(ctx, "/bars/taper", [](conceg_doc *doc) { put(doc, "/bars/taper", std::vector<double>()); });
  refused(ctx, "/cells/soma[0]", [](conceg_doc *doc) {
    put(doc, "/cells/soma", std::vector<double>{6, NAN, 0}, 3);
  });
  refused(ctx, "/bars", [](conceg_doc *doc) { must(conceg_doc_drop(doc, "/bars")); });
  refused(ctx, "/bars/cell_offset",
          [](conceg_doc *doc) {
            put(doc, "/bars/cell_offset", std::vector<std::uint64_t>{0, 1, 1});
          },
          {"triangulate.nodes=graded"});
  refused(ctx, "density_per_um3", {}, {"triangulate.density_per_um3=0"});
  refused(ctx, "grade_levels", {}, {"triangulate.grade_levels=3"});
  refused(ctx, "jitter", {}, {"triangulate.jitter=0.5"});
  conceg_ctx_free(ctx);
  return check_done();
}
