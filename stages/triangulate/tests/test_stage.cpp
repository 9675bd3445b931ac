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

// Runs the stage; "" and the network's digest, or the error line.
static std::string run(conceg_ctx *ctx, unsigned threads, std::vector<const char *> sets, std::string &digest,
                       const std::function<void(conceg_doc *)> &look) {
  conceg_ctx_set_threads(ctx, threads);
  conceg_ctx_clear_error(ctx);
  sets.push_back(nullptr);
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  conceg_status status = conceg_doc_new(ctx, &doc);
  if (status == CONCEG_OK) {
    write_tissue(doc);
    if (look) look(doc);
    status = conceg_params_new(ctx, &conceg_stage_triangulate, doc, nullptr, sets.data(), nullptr, &params);
  }
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_triangulate, doc, params);
  std::string line = status == CONCEG_OK ? "" : conceg_ctx_error(ctx);
  char hex[65] = "";
  if (status == CONCEG_OK) {
    CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
    CHECK_EQUAL(conceg_doc_digest(doc, "/network", hex), CONCEG_OK);
    const auto radius = view<float>(doc, "/network/radius");
    const auto position = view<double>(doc, "/network/position", 3);
    const auto offset = view<std::uint64_t>(doc, "/network/edge_offset");
    CHECK_EQUAL(offset.rows(), position.rows() + 1);
    float largest = -100, smallest = 100;
    for (const float r : radius)
      largest = std::max(largest, r), smallest = std::min(smallest, r);
    CHECK_NEAR(static_cast<double>(largest), 1.0, 1e-6); // 0.5 + 0.02 * 20 and the margin of 0.1
    CHECK(smallest < -3.0f && smallest >= -4.0f);
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

int main() {
  conceg_ctx *ctx = conceg_ctx_new();
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
  refused(ctx, "density_per_um3", {}, {"triangulate.density_per_um3=0"});
  refused(ctx, "jitter", {}, {"triangulate.jitter=0.5"});
  conceg_ctx_free(ctx);
  return check_done();
}
