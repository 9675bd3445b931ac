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

// Passing axons stand among the cells, without soma and donor, and leave the cells as they were.
static void test_passing_axons() {
  const std::string axons =
      "  - {name: x, class: axon, cable_density_per_um2: 0.05, radius_um: {minimum: 0.3},"
      " direction: {axis: [0, 0, -2], kappa: 20}}\n";
  conceg_doc *doc = run(recipe_text(axons.c_str()));
  CHECK(doc != nullptr);
  if (!doc) {
    std::fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    return;
  }
  CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
  const auto type = view<std::uint32_t>(doc, "/cells/type"), donor = view<std::uint32_t>(doc, "/cells/donor");
  const auto id = view<std::uint64_t>(doc, "/cells/id"),
             offset = view<std::uint64_t>(doc, "/bars/cell_offset");
  const auto radius = view<float>(doc, "/cells/radius");
  const auto soma = view<double>(doc, "/cells/soma", 3), attractor = view<double>(doc, "/bars/attractor", 3);
  const auto end = view<double>(doc, "/bars/asked_end"), thick = view<double>(doc, "/bars/radius");
  double cable = 0.0, along = 0.0;
  std::size_t cells = 0;
  for (std::size_t i = 0; i < type.rows(); i++) {
    CHECK_EQUAL(id[i] % 5, type[i]);
    CHECK(i == 0 || id[i] > id[i - 1]);
    CHECK_EQUAL(type[i] == 4, radius[i] == 0.0f);
    CHECK_EQUAL(type[i] == 4, donor[i] == 4294967295u);
    cells += type[i] != 4;
    if (type[i] != 4) continue;
    const std::uint64_t bar = offset[i];
    CHECK_EQUAL(offset[i + 1], bar + 1);
    CHECK_EQUAL(view<std::uint8_t>(doc, "/bars/neurite")[bar], CONCEG_SWC_AXON);
    CHECK(thick[bar] >= 0.3);
    cable += end[bar];
    along += std::pow(attractor.row(bar)[2] - soma.row(i)[2], 2) / end[bar];
  }
  CHECK_EQUAL(cells, 102);
  CHECK_NEAR(cable / 512000.0, 0.05, 1e-5);
  CHECK_NEAR(along / cable, 0.9486, 0.02); // Watson's law at kappa 20
  CHECK_EQUAL(view<std::uint64_t>(doc, "/types/placed")[4], type.rows() - 102);
  CHECK_EQUAL(view<std::uint64_t>(doc, "/types/asked")[4], type.rows() - 102);
  const auto fraction = view<double>(doc, "/types/fraction");
  CHECK_NEAR(fraction[0] + fraction[1] + fraction[2] + fraction[3], 1.0, 1e-12);
  CHECK_NEAR(fraction[4], 0.0, 0.0);
  const std::string first = digest(doc);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = run(recipe_text(axons.c_str()));
  CHECK(first == digest(doc));
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  // A box of axons alone, with what the recipe leaves out.
  doc = run("conceg: 1\ndomain: {size_um: [20, 20, 20]}\ntypes: [{name: x, class: axon}]\n");
  CHECK(doc != nullptr);
  if (!doc) return;
  CHECK_EQUAL(conceg_doc_validate(doc, nullptr, nullptr, nullptr), CONCEG_OK);
  CHECK_EQUAL(view<std::uint64_t>(doc, "/types/placed")[0], 140); // 0.35 x 8000 / 20
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

// The axon trees of the donors: those that have one give it, and the log says how many.
static std::string logged;
static void keep_log(void *, conceg_log_level, const char *line) {
  logged += line;
}
static void test_own_axons() {
  logged.clear();
  conceg_ctx_set_log(ctx, CONCEG_LOG_INFO, keep_log, nullptr);
  conceg_doc *doc = run(recipe_text(""), {"place.axons=true"});
  CHECK(doc != nullptr);
  if (!doc) return;
  const auto donor = view<std::uint32_t>(doc, "/cells/donor");
  const auto offset = view<std::uint64_t>(doc, "/bars/cell_offset"),
             tree_offset = view<std::uint64_t>(doc, "/dictionary/donor_tree_offset");
  const auto neurite = view<std::uint8_t>(doc, "/bars/neurite"),
             kind = view<std::uint8_t>(doc, "/dictionary/tree_neurite");
  std::size_t with = 0;
  for (std::size_t i = 0; i < donor.rows(); i++) {
    bool has_axon = false, asked = false;
    for (std::uint64_t b = offset[i]; b < offset[i + 1]; b++)
      asked |= neurite[b] == CONCEG_SWC_AXON;
    for (std::uint64_t t = tree_offset[donor[i]]; t < tree_offset[donor[i] + 1]; t++)
      has_axon |= kind[t] == CONCEG_SWC_AXON;
    CHECK_EQUAL(asked, has_axon);
    with += asked;
  }
  std::printf("%zu of %zu cells have an axon of their own\n", with, donor.rows());
  CHECK(with > 0 && with < donor.rows());
  char expected[80];
  std::snprintf(expected, sizeof expected, "%zu of %zu cells have an axon of their own", with, donor.rows());
  CHECK(logged.find(expected) != std::string::npos);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
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
  test_passing_axons();
  test_own_axons();
  refused({"density_per_um3=0.01"}, "lower the density");
  refused({"density_per_um3=1e-9"}, "at least one cell");
  refused({"domain.size_um=[80,9,80]"}, "enlarge domain.size_um");
  refused({"dictionary=no_such_file.cgx"}, "no_such_file.cgx");
  refused({"types=[{name: a, class: pyramidal, entry: L7_pyramidal, fraction: 1}]"},
          "no entry \"L7_pyramidal\"; it has: ");
  refused({"types=[{name: a, class: pyramidal, entry: L5_pyramidal, fraction: 0.5}]"}, "add up to 1");
  refused({"place.soma_gap_um=-1"}, "soma_gap_um");
  refused({"types=[{name: x, class: axon, cable_density_per_um2: 0}]"},
          "types[0].cable_density_per_um2: expected a number above 0, got 0");
  refused({"types=[{name: x, class: axon, cable_density_per_um2: 0.7}, {name: y, class: axon}]"},
          "at most 1 um of cable per um3 in all, got 1.05, for which there is no room beside cells; lower "
          "cable_density_per_um2");
  refused({"types=[{name: x, class: axon, direction: {axis: [0, 0, 1], kappa: -1}}]"},
          "types[0].direction.kappa: expected a number, 0 or more, got -1");
  refused({"types=[{name: x, class: axon, radius_um: {mean: 30}}]"},
          "types[0].radius_um: expected radii below a quarter of the box's shortest side, 20 um, got one of");
  conceg_ctx_free(ctx);
  return check_done();
}
