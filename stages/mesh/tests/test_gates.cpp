// SPDX-License-Identifier: BSD-3-Clause
// The gates of conceg check on files: a sound one passes; each defect is planted into a written document,
// which is saved, opened again, and must fail at the gate that stands for it.
#include "check.h"
#include "planted.hpp"

#include <cstring>

extern "C" const conceg_stage conceg_stage_check;

using namespace scenes;

namespace {

const char *const file = "test_mesh_gates.cgx", *const spoiled = "test_mesh_gates_spoiled.cgx";

struct Verdicts {
  std::vector<std::string> group, gate, verdict, note;
  std::string of(const std::string &name) const {
    for (std::size_t i = 0; i < gate.size(); i++)
      if (gate[i] == name) return verdict[i];
    return "no such gate";
  }
  std::string note_of(const std::string &name) const {
    for (std::size_t i = 0; i < gate.size(); i++)
      if (gate[i] == name) return note[i];
    return "";
  }
  std::vector<std::string> failed() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < gate.size(); i++)
      if (verdict[i] == "failed") names.push_back(gate[i]);
    return names;
  }
};

Verdicts check_file(conceg_ctx *ctx, const char *path, std::vector<const char *> sets = {}) {
  using namespace conceg;
  conceg_doc *doc = nullptr;
  must(conceg_doc_open(ctx, path, &doc));
  sets.push_back("check.points=200000"), sets.push_back(nullptr);
  conceg_params *params = nullptr;
  must(conceg_params_new(ctx, &conceg_stage_check, doc, nullptr, sets.data(), nullptr, &params));
  Verdicts out;
  CHECK_EQUAL(conceg_stage_run(ctx, &conceg_stage_check, doc, params), CONCEG_OK);
  conceg_params_free(params);
  out.group = texts(doc, "/statistics/gates/group"), out.gate = texts(doc, "/statistics/gates/gate");
  out.verdict = texts(doc, "/statistics/gates/verdict"), out.note = texts(doc, "/statistics/gates/looked_at");
  must(conceg_doc_close(doc));
  return out;
}

// What the gates say of the file once `spoil` has been at the document.
template <class Spoil> Verdicts judged(conceg_ctx *ctx, const Spoil &spoil) {
  conceg_doc *doc = nullptr;
  conceg::must(conceg_doc_open(ctx, file, &doc));
  spoil(doc);
  conceg::must(conceg_doc_save(doc, spoiled));
  conceg::must(conceg_doc_close(doc));
  const Verdicts verdicts = check_file(ctx, spoiled);
  std::remove(spoiled);
  return verdicts;
}

// Changes values of one array in place.
template <class T, class Change>
void edit(conceg_doc *doc, const char *path, std::size_t columns, const Change &change) {
  std::vector<T> values = copy<T>(doc, path, columns);
  change(values);
  conceg::put(doc, path, values, columns);
}

// Changes the geometry of /meshes and leaves all else in it.
template <class Change> void edit_meshes(conceg_doc *doc, const Change &change) {
  Meshes meshes = read_meshes(doc);
  change(meshes);
  conceg::put(doc, "/meshes/vertex", meshes.vertex, 3);
  conceg::put(doc, "/meshes/face", meshes.face, 3);
  conceg::put(doc, "/meshes/vertex_offset", meshes.vertex_offset);
  conceg::put(doc, "/meshes/face_offset", meshes.face_offset);
}

// The gate fails, and its line says `says`.
template <class Spoil>
void must_fail(conceg_ctx *ctx, const char *gate, const char *says, const Spoil &spoil) {
  const Verdicts verdicts = judged(ctx, spoil);
  const bool good = verdicts.of(gate) == "failed" && verdicts.note_of(gate).find(says) != std::string::npos;
  if (!good) {
    std::printf("%s: %s (%s); failed:", gate, verdicts.of(gate).c_str(), verdicts.note_of(gate).c_str());
    for (const std::string &name : verdicts.failed())
      std::printf(" [%s]", name.c_str());
    std::printf("\n");
  }
  CHECK(good);
}

// Two balls, a tube through the sides of the box, and a cell with a neurite of two bars that fork.
Tissue tissue_of_four() {
  Tissue tissue = empty_box(10);
  add_cell(tissue, {3, 5, 5}, 1.6);
  add_cell(tissue, {7, 5, 5}, 1.6);
  add_tube(tissue, {5, 1, -3}, {5.2, 1.3, 8}, 0.5);
  add_cell(tissue, {8, 8.5, 2}, 1);
  const std::int64_t root = add_point(tissue, {8, 8.5, 3}, 0.4, -1),
                     fork = add_point(tissue, {8, 8.5, 4.5}, 0.4, root);
  add_point(tissue, {8.6, 8.8, 6.5}, 0.4, fork);
  add_point(tissue, {7.2, 8.2, 6.5}, 0.4, fork);
  return tissue;
}

void write_bars(conceg_doc *doc) {
  using namespace conceg;
  put(doc, "/skeleton/branch", std::vector<std::uint32_t>{0, 0, 0, 0, 1, 2});
  put(doc, "/skeleton/bar", std::vector<std::uint32_t>{0, 0, 0, 0, 0, 1});
  put(doc, "/bars/cell_offset", std::vector<std::uint64_t>{0, 0, 0, 1, 3});
  put(doc, "/bars/tree", std::vector<std::uint32_t>{0, 0, 0});
  put(doc, "/bars/parent", std::vector<std::int64_t>{-1, -1, 0});
  put(doc, "/bars/neurite", std::vector<std::uint8_t>{3, 3, 3});
  put(doc, "/bars/asked_start", std::vector<double>{0, 0, 1.5});
  put(doc, "/bars/asked_end", std::vector<double>{11, 3.6, 3.7});
  put(doc, "/bars/achieved_start", std::vector<double>{0, 0, 1.5});
  put(doc, "/bars/achieved_end", std::vector<double>{11, 3.6, 3.7});
  put(doc, "/bars/attractor", std::vector<double>(9, 1.0), 3);
  put(doc, "/bars/angle", std::vector<double>(3, 0.5));
  put(doc, "/bars/radius", std::vector<double>(3, 0.4));
  put(doc, "/bars/taper", std::vector<double>(3, 0.0));
  put(doc, "/bars/radius_floor", std::vector<double>(3, 0.15));
  put(doc, "/bars/state", std::vector<std::uint8_t>{1, 1, 1});
  put(doc, "/bars/handed_to", std::vector<std::int64_t>{-1, -1, -1});
}

void a_sound_file_passes(conceg_ctx *ctx) {
  const Verdicts verdicts = check_file(ctx, file);
  for (std::size_t i = 0; i < verdicts.gate.size(); i++)
    if (verdicts.verdict[i] != "passed")
      std::printf("%s: %s: %s (%s)\n", verdicts.verdict[i].c_str(), verdicts.group[i].c_str(),
                  verdicts.gate[i].c_str(), verdicts.note[i].c_str());
  CHECK(verdicts.failed().empty());
  CHECK(verdicts.gate.size() > 30);
  // Void: all sides are periodic; no levels; no walkers. Nothing else.
  CHECK_EQUAL(std::count(verdicts.verdict.begin(), verdicts.verdict.end(), "void"), 3);
  CHECK_TEXT(verdicts.of("no walker leaks").c_str(), "void");
}

void skeletons_and_bars(conceg_ctx *ctx) {
  must_fail(ctx, "tree order", "cell 3, point 2: parent 3", [](conceg_doc *doc) {
    edit<std::int64_t>(doc, "/skeleton/parent", 1, [](auto &parent) { parent[4] = 3; });
  });
  must_fail(ctx, "radii", "cell 3, point 1: 0 um", [](conceg_doc *doc) {
    edit<float>(doc, "/skeleton/radius", 1, [](auto &radius) { radius[3] = 0; });
  });
  must_fail(ctx, "places", "cell 2, point 1", [](conceg_doc *doc) {
    edit<double>(doc, "/skeleton/position", 3, [](auto &place) { place[4] = NAN; });
  });
  must_fail(ctx, "roots at their soma", "farthest in cell 3", [](conceg_doc *doc) {
    edit<double>(doc, "/skeleton/position", 3, [](auto &place) { place[8] += 7; });
  });
  must_fail(ctx, "somata in the box", "cell 1 at (17, 5, 5) um",
            [](conceg_doc *doc) { edit<double>(doc, "/cells/soma", 3, [](auto &soma) { soma[3] += 10; }); });
  must_fail(ctx, "no empty cell", "cell 0 has neither soma nor skeleton", [](conceg_doc *doc) {
    edit<float>(doc, "/cells/radius", 1, [](auto &radius) { radius[0] = 0; });
  });
  must_fail(ctx, "cable asked for", "of 116.8", [](conceg_doc *doc) {
    edit<double>(doc, "/bars/asked_end", 1, [](auto &end) { end[0] = 111; });
  });
  must_fail(ctx, "tips asked for", "cell 3 has 2 tips for 1 bars", [](conceg_doc *doc) {
    edit<std::uint8_t>(doc, "/bars/state", 1, [](auto &state) { state[2] = 3; });
  });
  must_fail(ctx, "bars in the skeleton", "cell 3, bar 1 (state 1) has no point", [](conceg_doc *doc) {
    edit<std::uint32_t>(doc, "/skeleton/bar", 1, [](auto &bar) { bar[5] = 0; });
  });
  must_fail(ctx, "format", "CGX-036 /skeleton/kind", [](conceg_doc *doc) {
    edit<std::uint8_t>(doc, "/skeleton/kind", 1, [](auto &kind) { kind[0] = 9; });
  });
  must_fail(ctx, "origins", "/meshes", [](conceg_doc *doc) {
    edit<double>(doc, "/cells/soma", 3, [](auto &soma) { soma[0] += 0.25; });
  });
}

void surfaces(conceg_ctx *ctx) {
  must_fail(ctx, "no two cells cross", "cell 0", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) {
      const std::size_t v = extreme(m, 0, 1);
      m.move(0, v, m.at(0, v) + glm::dvec3(2.0, 0, 0));
    });
  });
  // Through the side of the box, into the image of cell 1.
  must_fail(ctx, "no two cells cross", "cell 1", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) {
      const std::size_t v = extreme(m, 0, -1);
      m.move(0, v, m.at(0, v) - glm::dvec3(4.0, 0, 0));
    });
  });
  must_fail(ctx, "no cell crosses its own image", "cell 0", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) { // as wide as the box and more, thin
      for (std::size_t u = 0; u < m.vertices(0); u++) {
        const glm::dvec3 p = m.at(0, u);
        m.move(0, u, {3 + 3.6 * (p.x - 3), 5 + 0.02 * (p.y - 5), 8 + 0.02 * (p.z - 5)});
      }
    });
  });
  must_fail(ctx, "no cell crosses itself", "cell 1", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) {
      const std::uint32_t *f = m.corners(1, 40);
      const glm::dvec3 at = m.at(1, f[0]);
      m.move(1, f[0], at + 2.5 * (m.at(1, f[1]) - at));
    });
  });
  must_fail(ctx, "oriented outward", "face turned against its neighbour: cell 1", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) {
      std::uint32_t *f = m.corners(1, 7);
      std::swap(f[0], f[1]);
    });
  });
  must_fail(ctx, "closed", "open edge: cell 1", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) { // a face that stands twice leaves a hole where the other was
      std::copy(m.corners(1, 8), m.corners(1, 8) + 3, m.corners(1, 7));
    });
  });
  must_fail(ctx, "manifold", "vertex with several fans: cell 1", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) { // two vertices far apart become one
      const std::size_t from = extreme(m, 1, 1), to = extreme(m, 1, -1);
      for (std::uint64_t i = 3 * m.face_offset[1]; i < 3 * m.face_offset[2]; i++)
        if (m.face[i] == from) m.face[i] = static_cast<std::uint32_t>(to);
    });
  });
  must_fail(ctx, "gap", "narrow gap: cell 0", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) {
      shift(m, 1, m.at(0, extreme(m, 0, 1)) + glm::dvec3(1e-6, 0, 0) - m.at(1, extreme(m, 1, -1)));
    });
  });
  must_fail(ctx, "values", "cell 1, vertex 11", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) { m.vertex[3 * (m.vertex_offset[1] + 11)] += 1e-12; });
  });
  must_fail(ctx, "rows", "cell 0 has two closed surfaces", [](conceg_doc *doc) {
    edit<std::uint32_t>(doc, "/meshes/cell", 1, [](auto &cell) { cell[1] = 0; });
  });
  must_fail(ctx, "every cell has its surface", "cell 1 has no surface", [](conceg_doc *doc) {
    edit<std::uint32_t>(doc, "/meshes/cell", 1, [](auto &cell) { cell[1] = 0; });
  });
  must_fail(ctx, "every cell has its surface", "cell 2 has no surface", [](conceg_doc *doc) {
    edit<std::uint8_t>(doc, "/meshes/lod", 1, [](auto &lod) { lod[2] = 1; });
  });
  must_fail(ctx, "rows", "lengths that do not fit", [](conceg_doc *doc) {
    edit<double>(doc, "/meshes/origin", 3, [](auto &origin) { origin.resize(6); });
  });
  must_fail(ctx, "one piece", "cell 0 has 2 pieces", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) { // a second small ball, a copy of cell 0's, goes into cell 0's rows
      const std::size_t vertices = m.vertices(0), faces = m.face_offset[1];
      const std::vector<double> old(m.vertex.begin(), m.vertex.begin() + 3 * std::ptrdiff_t(vertices));
      const std::vector<std::uint32_t> corners(m.face.begin(), m.face.begin() + 3 * std::ptrdiff_t(faces));
      m.vertex.insert(m.vertex.begin(), old.begin(), old.end());
      m.face.insert(m.face.begin() + 3 * std::ptrdiff_t(faces), corners.begin(), corners.end());
      for (std::size_t i = 3 * faces; i < 6 * faces; i++)
        m.face[i] += static_cast<std::uint32_t>(vertices);
      for (std::size_t k = 1; k < m.vertex_offset.size(); k++)
        m.vertex_offset[k] += vertices, m.face_offset[k] += faces;
      for (std::size_t v = 0; v < vertices; v++)
        m.move(0, v, 0.1 * (m.at(0, v) - glm::dvec3(3, 5, 5)) + glm::dvec3(3, 9, 9));
    });
  });
  must_fail(ctx, "genus as stored", "cell 2: stored 1, counted 0", [](conceg_doc *doc) {
    edit<std::int64_t>(doc, "/meshes/genus", 1, [](auto &genus) { genus[2] = 1; });
  });
  must_fail(ctx, "measures as stored", "cell 1: area", [](conceg_doc *doc) {
    edit<double>(doc, "/meshes/area", 1, [](auto &area) { area[1] *= 1.000001; });
  });
  must_fail(ctx, "detached pieces", "of 1 cells", [](conceg_doc *doc) {
    edit<double>(doc, "/meshes/detached_volume", 1, [](auto &detached) { detached[0] = 3; });
  });
  must_fail(ctx, "volume fraction as stored", "stored 0.3",
            [](conceg_doc *doc) { conceg::put_scalar(doc, "/meshes@icvf", 0.3); });
}

void labels_and_volumes(conceg_ctx *ctx) {
  must_fail(ctx, "compartments of faces", "cell 0, face 5: compartment 3", [](conceg_doc *doc) {
    edit<std::uint8_t>(doc, "/meshes/compartment", 1, [](auto &code) { code[5] = 3; });
  });
  must_fail(ctx, "sections of faces", "section 7", [](conceg_doc *doc) {
    edit<std::uint32_t>(doc, "/meshes/section", 1, [](auto &section) { section.back() = 7; });
  });
  must_fail(ctx, "faces at their section", "section 1", [](conceg_doc *doc) { // the two daughters, exchanged
    edit<std::uint32_t>(doc, "/meshes/section", 1, [&](auto &section) {
      for (std::size_t i = copy<std::uint64_t>(doc, "/meshes/face_offset")[3]; i < section.size(); i++)
        if (section[i] == 1 || section[i] == 2) section[i] = 3 - section[i];
    });
  });
  must_fail(ctx, "volume fraction by labels", "by voxels", [](conceg_doc *doc) {
    edit<std::uint32_t>(doc, "/volumes/label", 512, [](auto &label) {
      for (std::uint32_t &l : label)
        if (l == 2) l = 0;
    });
  });
  must_fail(ctx, "labels in place", "label of cell 1 in cell 0", [](conceg_doc *doc) {
    edit<std::uint32_t>(doc, "/volumes/label", 512, [](auto &label) {
      for (std::uint32_t &l : label)
        if (l == 1 || l == 2) l = 3 - l;
    });
  });
  must_fail(ctx, "volumes of cells by labels", "cell", [](conceg_doc *doc) {
    edit<std::uint32_t>(doc, "/volumes/label", 512, [](auto &label) {
      for (std::size_t i = 0; i < label.size(); i += 8)
        if (label[i] == 2) label[i] = 1;
    });
  });
  // Half of one ball's faces turned inside out: points in it are no longer found.
  must_fail(ctx, "volume fraction by points", "by", [](conceg_doc *doc) {
    edit_meshes(doc, [](Meshes &m) {
      for (std::size_t f = 0; f < m.face_offset[2] - m.face_offset[1]; f++) {
        std::uint32_t *corner = m.corners(1, f);
        if (m.at(1, corner[0]).x > 7) std::swap(corner[0], corner[1]);
      }
    });
  });
}

// A hollow cell: the space in it is cut off from the rest. Nor is there anything that volumes, bars and
// branches could be read from.
void closed_space(conceg_ctx *ctx) {
  Tissue tissue = empty_box(8);
  add_cell(tissue, {4, 4, 4}, 0);
  std::int64_t row = -1;
  for (int i = 0; i <= 600; i++) { // a spiral of 16 turns on a sphere
    const double polar = 3.14159265 * i / 600, angle = 32 * polar;
    row = add_point(tissue,
                    glm::dvec3(4) + 2.5 * glm::dvec3(std::sin(polar) * std::cos(angle),
                                                     std::sin(polar) * std::sin(angle), std::cos(polar)),
                    0.6, row);
  }
  conceg_doc *doc = document_of(ctx, tissue);
  CHECK_EQUAL(run_stage(ctx, doc, {"mesh.h_um=0.25", "mesh.volumes=false"}), CONCEG_OK);
  conceg::must(conceg_doc_save(doc, spoiled));
  conceg::must(conceg_doc_close(doc));
  const char *const in_one_piece = "extracellular space in one piece";
  const Verdicts verdicts = check_file(ctx, spoiled);
  CHECK_TEXT(verdicts.of(in_one_piece).c_str(), "failed");
  CHECK(verdicts.note_of(in_one_piece).find("of 2 pieces") != std::string::npos);
  for (const char *name : {"volume fraction by labels", "cable asked for", "compartments of faces"})
    CHECK_TEXT(verdicts.of(name).c_str(), "void");
  CHECK_TEXT(check_file(ctx, spoiled, {"check.space=false"}).of(in_one_piece).c_str(), "void");
  std::remove(spoiled);
}

// Label and distance of the voxel that holds a place of the box.
std::pair<std::uint32_t, float> voxel_at(conceg_doc *doc, const glm::dvec3 &p) {
  const auto leaf = copy<std::int32_t>(doc, "/volumes/leaf_origin", 3);
  const auto label = copy<std::uint32_t>(doc, "/volumes/label", 512);
  const auto distance = copy<float>(doc, "/volumes/distance", 512);
  const auto origin = copy<double>(doc, "/volumes@origin"), spacing = copy<double>(doc, "/volumes@spacing");
  int at[3];
  for (int axis = 0; axis < 3; axis++)
    at[axis] = static_cast<int>(std::lround((p[axis] - origin[static_cast<std::size_t>(axis)]) /
                                            spacing[static_cast<std::size_t>(axis)]));
  for (std::size_t row = 0; row < leaf.size() / 3; row++) {
    const int x = at[0] - leaf[3 * row], y = at[1] - leaf[3 * row + 1], z = at[2] - leaf[3 * row + 2];
    if (x < 0 || y < 0 || z < 0 || x > 7 || y > 7 || z > 7) continue;
    const auto k = 512 * row + static_cast<std::size_t>(64 * x + 8 * y + z);
    return {label[k], distance[k]};
  }
  return {0, 1e9f};
}

// Neurites with a waist that the grid cannot hold: what the meshes leave out is in no volume, and keeps its
// neighbour away all the same. Of a cell without soma the larger part stays, wherever its root is.
void left_out_pieces(conceg_ctx *ctx) {
  Tissue tissue = empty_box(16);
  const auto add_waist = [&](double y, double from, double end) {
    std::int64_t row = add_point(tissue, {from, y, 8.125}, 0.5, -1);
    row = add_point(tissue, {from + 2, y, 8.125}, 0.5, row);
    row = add_point(tissue, {from + 3, y, 8.125}, 0.05, row);
    row = add_point(tissue, {from + 4, y, 8.125}, 0.6, row);
    add_point(tissue, {end, y, 8.125}, 0.6, row);
  };
  add_cell(tissue, {4, 4, 8}, 2);
  add_waist(4.125, 6, 13); // halfway between nodes
  add_cell(tissue, {8, 12, 8}, 0);
  add_waist(12.125, 1, 14);
  add_tube(tissue, {12, 5.225, 2}, {12, 5.225, 14}, 0.6); // presses on the part of cell 0 that is left out
  conceg_doc *doc = document_of(ctx, tissue);
  CHECK_EQUAL(run_stage(ctx, doc, {"mesh.h_um=0.25", "mesh.volume_step_um=0.1"}), CONCEG_OK);
  const auto detached = copy<double>(doc, "/meshes/detached_volume");
  CHECK(detached[0] > 2 && detached[1] > 1 && detached[2] == 0);
  CHECK_EQUAL(voxel_at(doc, {7, 4, 8}).first, 1);
  CHECK_EQUAL(voxel_at(doc, {11, 4, 8}).first, 0);
  CHECK(voxel_at(doc, {11, 4, 8}).second > 0);
  CHECK_EQUAL(voxel_at(doc, {2, 12, 8}).first, 0);
  CHECK(voxel_at(doc, {2, 12, 8}).second > 0);
  CHECK_EQUAL(voxel_at(doc, {8, 12, 8}).first, 2);
  CHECK(voxel_at(doc, {8, 12, 8}).second < -0.15f);
  // Its side of the contact plane ends at y = 4.675 + g/2; where nothing presses it reaches to 4.625.
  CHECK_EQUAL(voxel_at(doc, {12, 5, 8}).first, 3);
  CHECK_EQUAL(voxel_at(doc, {12, 4.65, 8}).first, 0);
  CHECK_EQUAL(voxel_at(doc, {12, 4.66, 3}).first, 3);
  conceg::must(conceg_doc_save(doc, spoiled));
  conceg::must(conceg_doc_close(doc));
  const Verdicts verdicts = check_file(ctx, spoiled);
  for (const char *name : {"volume fraction by labels", "volumes of cells by labels", "labels in place"})
    CHECK_TEXT(verdicts.of(name).c_str(), "passed");
  CHECK_TEXT(verdicts.of("detached pieces").c_str(), "failed");
  std::remove(spoiled);
}

// Coarser levels: closed, manifold, of the same volume and genus, with fewer faces; they stand behind level
// 0, change nothing in it, and readers that know no levels get level 0 alone.
void levels_of_detail(conceg_ctx *ctx) {
  const Tissue tissue = tissue_of_four();
  conceg_doc *doc = document_of(ctx, tissue), *plain = document_of(ctx, tissue);
  CHECK_EQUAL(run_stage(ctx, plain, {"mesh.h_um=0.2", "mesh.volumes=false"}), CONCEG_OK);
  CHECK_EQUAL(
      run_stage(ctx, doc, {"mesh.h_um=0.2", "mesh.volumes=false", "mesh.levels=3", "mesh.level_um=0.1"}),
      CONCEG_OK);
  CHECK_TEXT(conceg_ctx_error(ctx), "");
  const auto lod = copy<std::uint8_t>(doc, "/meshes/lod");
  CHECK(lod == (std::vector<std::uint8_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3}));
  const auto vertex = copy<double>(doc, "/meshes/vertex", 3),
             finest = copy<double>(plain, "/meshes/vertex", 3);
  CHECK(vertex.size() > finest.size() && std::equal(finest.begin(), finest.end(), vertex.begin()));
  const auto volume = copy<double>(doc, "/meshes/volume");
  const auto genus = copy<std::int64_t>(doc, "/meshes/genus");
  const auto faces = copy<std::uint64_t>(doc, "/meshes/face_offset");
  const auto cell = copy<std::uint32_t>(doc, "/meshes/cell");
  const auto code = copy<std::uint8_t>(doc, "/meshes/compartment");
  for (std::size_t k = 4; k < lod.size(); k++) {
    CHECK_EQUAL(cell[k], k % 4);
    CHECK_NEAR(volume[k] / volume[k % 4], 1, 1e-4);
    CHECK_EQUAL(genus[k], genus[k % 4]);
    CHECK(faces[k + 1] - faces[k] < faces[k - 3] - faces[k - 4]);
  }
  // The last level is left with hardly more than what a closed surface needs: 14 faces of a ball.
  CHECK(faces[8] - faces[4] < (faces[4] - faces[0]) / 2);
  CHECK(faces[16] - faces[12] < (faces[4] - faces[0]) / 5);
  CHECK_EQUAL(code.size(), faces[16]);
  CHECK(conceg::view<double>(doc, "/meshes@icvf")[0] == conceg::view<double>(plain, "/meshes@icvf")[0]);
  conceg_substrate *substrate = nullptr;
  conceg::must(conceg_substrate_open(doc, &substrate));
  CHECK_EQUAL(conceg_substrate_meshes(substrate), 4);
  conceg_substrate_free(substrate);
  conceg::must(conceg_doc_save(doc, file));
  const Verdicts verdicts = check_file(ctx, file);
  CHECK(verdicts.failed().empty());
  CHECK_TEXT(verdicts.of("coarser levels closed").c_str(), "passed");
  must_fail(ctx, "coarser levels closed", "open edge: cell 0, face", [](conceg_doc *spoilt) {
    edit<std::uint32_t>(spoilt, "/meshes/face", 3, [&](auto &corner) {
      const auto first = 3 * copy<std::uint64_t>(spoilt, "/meshes/face_offset")[4];
      std::copy(corner.begin() + std::ptrdiff_t(first + 3), corner.begin() + std::ptrdiff_t(first + 6),
                corner.begin() + std::ptrdiff_t(first));
    });
  });
  // Level 0 behind a coarser one: refused, not misread.
  edit<std::uint8_t>(doc, "/meshes/lod", 1, [](auto &levels) { std::swap(levels[3], levels[4]); });
  CHECK_EQUAL(conceg_substrate_open(doc, &substrate), CONCEG_E_FORMAT);
  CHECK(std::strstr(conceg_ctx_error(ctx), "/meshes/lod[4]") != nullptr);
  conceg::must(conceg_doc_close(doc));
  conceg::must(conceg_doc_close(plain));
}

} // namespace

int main() {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = document_of(ctx, tissue_of_four());
  write_bars(doc);
  CHECK_EQUAL(run_stage(ctx, doc, {"mesh.h_um=0.2", "mesh.volume_step_um=0.1"}), CONCEG_OK);
  CHECK_TEXT(conceg_ctx_error(ctx), "");
  conceg::must(conceg_doc_save(doc, file));
  conceg::must(conceg_doc_close(doc));
  a_sound_file_passes(ctx);
  skeletons_and_bars(ctx);
  surfaces(ctx);
  labels_and_volumes(ctx);
  closed_space(ctx);
  left_out_pieces(ctx);
  levels_of_detail(ctx);
  std::remove(file);
  conceg_ctx_free(ctx);
  return check_done();
}
