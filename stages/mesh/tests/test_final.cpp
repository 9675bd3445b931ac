// SPDX-License-Identifier: BSD-3-Clause
// The final check on files: each defect is planted into a written document, which is saved, opened again and
// must be named with its place.
#include "check.h"
#include "final_check.hpp"
#include "planted.hpp"

#include <cstring>

using namespace scenes;

namespace {

void write_meshes(conceg_doc *doc, const Meshes &m) {
  using namespace conceg;
  must(conceg_doc_drop(doc, "/meshes"));
  put(doc, "/meshes/cell", m.cell);
  put(doc, "/meshes/lod", std::vector<std::uint8_t>(m.cell.size()));
  put_texts(doc, "/meshes/form", std::vector<std::string>(m.cell.size(), "closed"));
  put(doc, "/meshes/origin", m.origin, 3);
  put(doc, "/meshes/vertex_offset", m.vertex_offset);
  put(doc, "/meshes/face_offset", m.face_offset);
  put(doc, "/meshes/vertex", m.vertex, 3);
  put(doc, "/meshes/face", m.face, 3);
}

const char *const file = "test_mesh_final.cgx";

// What the check says of the file once `spoil` has been at it.
template <class Spoil> std::vector<std::string> judged(conceg_ctx *ctx, const Spoil &spoil) {
  conceg_doc *doc = nullptr;
  conceg::must(conceg_doc_open(ctx, file, &doc));
  Meshes meshes = read_meshes(doc);
  spoil(meshes);
  write_meshes(doc, meshes);
  conceg::must(conceg_doc_save(doc, "test_mesh_spoiled.cgx"));
  conceg::must(conceg_doc_close(doc));
  conceg::must(conceg_doc_open(ctx, "test_mesh_spoiled.cgx", &doc));
  conceg::Workers workers(2);
  const std::vector<std::string> lines = check_document(doc, 0.02, 0.09, 64u << 20, workers, {}).lines(10000);
  conceg::must(conceg_doc_close(doc));
  std::remove("test_mesh_spoiled.cgx");
  return lines;
}

// One of the lines begins with `what`, and where it names a place that is near `where`.
bool names(const std::vector<std::string> &lines, const char *what, const glm::dvec3 &where) {
  for (const std::string &line : lines) {
    if (line.compare(0, std::strlen(what), what) != 0) continue;
    const std::size_t at = line.find("at (");
    glm::dvec3 p;
    if (at != std::string::npos &&
        std::sscanf(line.c_str() + at, "at (%lf, %lf, %lf)", &p.x, &p.y, &p.z) == 3 &&
        glm::length(p - where) < 1.0)
      return true;
  }
  std::printf("not found: %s near %.2f %.2f %.2f; said:\n", what, where.x, where.y, where.z);
  for (std::size_t i = 0; i < std::min<std::size_t>(4, lines.size()); i++)
    std::printf("  %s\n", lines[i].c_str());
  return false;
}

void defects_are_named(conceg_ctx *ctx) {
  CHECK(judged(ctx, [](Meshes &) {}).empty());
  // Cells 0 and 1 are balls around x = 3 and 7, cell 2 a tube through the sides of the box.
  glm::dvec3 where;
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       where = {4.5, 5, 5};
                       const std::size_t v = extreme(m, 0, 1);
                       m.move(0, v, m.at(0, v) + glm::dvec3(2.0, 0, 0));
                     }),
              "two cells cross", {5.5, 5, 5}));
  // A spike out of the left of cell 0, through the side of the box, into the image of cell 1 there.
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       const std::size_t v = extreme(m, 0, -1);
                       m.move(0, v, m.at(0, v) - glm::dvec3(4.0, 0, 0));
                     }),
              "two cells cross", {-1.5, 5, 5}));
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       const std::size_t v = extreme(m, 0, -1);
                       where = m.at(0, v);
                       for (std::size_t u = 0; u < m.vertices(0); u++) { // as wide as the box and more, thin
                         const glm::dvec3 p = m.at(0, u);
                         m.move(0, u, {3 + 3.6 * (p.x - 3), 5 + 0.02 * (p.y - 5), 8 + 0.02 * (p.z - 5)});
                       }
                       for (std::size_t u = 0; u < m.vertices(1); u++) // out of the way
                         m.move(1, u, 0.2 * (m.at(1, u) - glm::dvec3(7, 5, 5)) + glm::dvec3(7, 5, 5));
                     }),
              "cell crosses its own image", {-2.0, 5, 8}));
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       const std::uint32_t *f = m.corners(1, 40);
                       where = m.at(1, f[0]);
                       m.move(1, f[0], where + 2.5 * (m.at(1, f[1]) - where));
                     }),
              "fold", where));
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       std::uint32_t *f = m.corners(1, 7);
                       where = m.at(1, f[0]);
                       std::swap(f[0], f[1]);
                     }),
              "face turned against its neighbour", where));
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       where = m.at(2, m.corners(2, m.face_offset[3] - m.face_offset[2] - 1)[0]);
                       m.face.resize(m.face.size() - 3), m.face_offset[3]--;
                     }),
              "open edge", where));
  // One millionth of a micrometre between two cells.
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       where = m.at(0, extreme(m, 0, 1));
                       shift(m, 1, where + glm::dvec3(1e-6, 0, 0) - m.at(1, extreme(m, 1, -1)));
                     }),
              "narrow gap", where));
  CHECK(names(judged(ctx,
                     [&](Meshes &m) {
                       where = m.at(1, 11);
                       m.vertex[3 * (m.vertex_offset[1] + 11)] += 1e-12;
                     }),
              "vertex is not its origin plus a single-precision value", where));
  const std::vector<std::string> lost = judged(ctx, [](Meshes &m) { drop_row(m, 1); });
  CHECK(lost.size() == 1 && lost[0] == "cell 1 has no surface");
  const std::vector<std::string> twice = judged(ctx, [](Meshes &m) { m.cell[1] = 0; });
  CHECK(!twice.empty() && twice[0] == "/meshes/cell: cell 0 has two closed surfaces");
  const std::vector<std::string> short_of = judged(ctx, [](Meshes &m) { m.origin.resize(6); });
  CHECK(short_of.size() == 1 && short_of[0].find("do not fit together") != std::string::npos);
}

} // namespace

int main() {
  Tissue tissue = empty_box(10);
  add_cell(tissue, {3, 5, 5}, 1.6);
  add_cell(tissue, {7, 5, 5}, 1.6);
  add_tube(tissue, {5, 1, -3}, {5.2, 1.3, 8}, 0.5); // passes its own image at some distance
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = document_of(ctx, tissue);
  CHECK_EQUAL(run_stage(ctx, doc, {"mesh.h_um=0.25", "mesh.volumes=false"}), CONCEG_OK);
  CHECK_TEXT(conceg_ctx_error(ctx), "");
  conceg::must(conceg_doc_save(doc, file));
  conceg::must(conceg_doc_close(doc));
  defects_are_named(ctx);
  std::remove(file);
  conceg_ctx_free(ctx);
  return check_done();
}
