// SPDX-License-Identifier: BSD-3-Clause
// The place stage as the host runs it, on the embedded dictionary: counts, valid groups, apical trees towards
// the pia, same bytes again, another seed, a dictionary file, and one clear line for each wrong recipe.
#include "run_place.hpp"

#include "conceg/swc.h"

#include <cstdio>

static void test_tissue() {
  conceg_doc *doc = run(recipe_text(""));
  CHECK(doc != nullptr);
  if (!doc) {
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    return;
  }
  CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
  const auto asked = view<std::uint64_t>(doc, "/types/asked"),
             placed = view<std::uint64_t>(doc, "/types/placed");
  const std::uint64_t expected[4] = {20, 31, 31, 20}; // 102.4 cells: 20.48 30.72 30.72 20.48
  for (int t = 0; t < 4; t++) {
    CHECK_EQUAL(asked[t], expected[t]);
    CHECK_EQUAL(placed[t], expected[t]);
  }
  CHECK_NEAR(view<double>(doc, "/domain@hi", 3)[2], 80.0, 0);  // on the lattice
  CHECK_EQUAL(texts(doc, "/dictionary/entry_name").size(), 4); // only what is used
  const auto type = view<std::uint32_t>(doc, "/cells/type");
  const auto soma = view<double>(doc, "/cells/soma", 3), attractor = view<double>(doc, "/bars/attractor", 3);
  const auto offset = view<std::uint64_t>(doc, "/bars/cell_offset");
  const auto neurite = view<std::uint8_t>(doc, "/bars/neurite");
  const auto id = view<std::uint64_t>(doc, "/cells/id");
  std::size_t pyramidal = 0, upright = 0;
  for (std::size_t i = 0; i < type.rows(); i++) {
    CHECK_EQUAL(id[i] % 4, type[i]);
    CHECK(i == 0 || id[i] > id[i - 1]);
    if (type[i] == 3) continue;
    double rise = 0.0;
    std::size_t tips = 0;
    for (std::uint64_t b = offset[i]; b < offset[i + 1]; b++) {
      CHECK(neurite[b] != CONCEG_SWC_AXON);
      if (neurite[b] == CONCEG_SWC_APICAL) rise += attractor.row(b)[2] - soma.row(i)[2], tips++;
    }
    if (tips == 0) continue;
    pyramidal++;
    upright += rise > 0.0;
  }
  std::printf("apical tips towards the pia: %zu of %zu cells\n", upright, pyramidal);
  CHECK(pyramidal > 70);
  CHECK(10 * upright >= 9 * pyramidal);
  const std::string first = digest(doc);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = run(recipe_text(""));
  CHECK(first == digest(doc));
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = run(recipe_text(""), {"seed=4"});
  CHECK(doc && first != digest(doc));
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

// Turning the pia turns the apical trees with it.
static void test_pia() {
  conceg_doc *doc = run(recipe_text(""), {"domain.pia=[0,-2,0]"});
  CHECK(doc != nullptr);
  if (!doc) return;
  CHECK_NEAR(view<double>(doc, "/domain@pia", 3)[1], -1.0, 0);
  const auto soma = view<double>(doc, "/cells/soma", 3), attractor = view<double>(doc, "/bars/attractor", 3);
  const auto offset = view<std::uint64_t>(doc, "/bars/cell_offset");
  const auto neurite = view<std::uint8_t>(doc, "/bars/neurite");
  double rise = 0.0;
  for (std::size_t i = 0; i < soma.rows(); i++)
    for (std::uint64_t b = offset[i]; b < offset[i + 1]; b++)
      if (neurite[b] == CONCEG_SWC_APICAL) rise += soma.row(i)[1] - attractor.row(b)[1];
  CHECK(rise > 0.0);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

// Layers, an own density and a profile reach the document, and somas stay in their layer.
static void test_layers() {
  conceg_doc *doc =
      run("conceg: 1\ndomain: {lo_um: [0, 0, -50], hi_um: [100, 100, 50], periodic: [true, true, false]}\n"
          "layers:\n  - {name: low, z_um: [-50, 0], density_per_um3: 4e-5}\n  - {name: high, z_um: [0, 50], "
          "density_per_um3: 6e-5}\n"
          "types:\n  - {name: a, class: interneuron, entry: L5_interneuron, layer: low, fraction: 1}\n"
          "  - {name: b, class: interneuron, entry: L4_interneuron, layer: high, fraction: 1}\n"
          "  - {name: c, class: microglia, entry: microglia, density_per_um3: 5e-6}\n");
  CHECK(doc != nullptr);
  if (!doc) {
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    return;
  }
  const auto placed = view<std::uint64_t>(doc, "/types/placed");
  CHECK(placed[0] == 20 && placed[1] == 30 && placed[2] == 5);
  CHECK_NEAR(view<double>(doc, "/domain/layer_density")[1], 6e-5, 1e-12);
  const auto type = view<std::uint32_t>(doc, "/cells/type");
  const auto soma = view<double>(doc, "/cells/soma", 3);
  for (std::size_t i = 0; i < type.rows(); i++)
    CHECK(type[i] == 2 || (type[i] == 0) == (soma.row(i)[2] < 0));
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

// A document that place wrote is itself a dictionary file.
static void test_dictionary_file() {
  const char *path = "test_place_dictionary.cgx";
  conceg_doc *doc = run(recipe_text(""));
  CHECK(doc != nullptr);
  if (!doc) return;
  CHECK_EQUAL(conceg_doc_save(doc, path), CONCEG_OK);
  conceg_doc *again = run(recipe_text(""), {"dictionary=test_place_dictionary.cgx"});
  CHECK(again != nullptr);
  char a[65], b[65];
  if (again) {
    CHECK_EQUAL(conceg_doc_digest(doc, "/bars", a), CONCEG_OK);
    CHECK_EQUAL(conceg_doc_digest(again, "/bars", b), CONCEG_OK);
    CHECK_TEXT(a, b);
    CHECK_EQUAL(conceg_doc_close(again), CONCEG_OK);
  }
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  std::remove(path);
}

static void refused(std::vector<const char *> sets, const char *expected) {
  conceg_doc *doc = run(recipe_text(""), std::move(sets));
  CHECK(doc == nullptr);
  const std::string line = conceg_ctx_error(ctx);
  CHECK(line.find(expected) != std::string::npos && line.find('\n') == std::string::npos);
  if (line.find(expected) == std::string::npos)
    std::fprintf(stderr, "expected \"%s\" in \"%s\"\n", expected, line.c_str());
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

int main() {
  ctx = conceg_ctx_new();
  test_tissue();
  test_pia();
  test_layers();
  test_dictionary_file();
  refused({"density_per_um3=0.01"}, "lower the density");
  refused({"density_per_um3=1e-9"}, "at least one cell");
  refused({"domain.size_um=[80,9,80]"}, "enlarge domain.size_um");
  refused({"dictionary=no_such_file.cgx"}, "no_such_file.cgx");
  refused({"types=[{name: a, class: pyramidal, entry: L7_pyramidal, fraction: 1}]"},
          "no entry \"L7_pyramidal\"; it has: ");
  refused({"types=[{name: a, class: pyramidal, entry: L5_pyramidal, fraction: 0.5}]"}, "add up to 1");
  refused({"place.soma_gap_um=-1"}, "soma_gap_um");
  conceg_ctx_free(ctx);
  return check_done();
}
