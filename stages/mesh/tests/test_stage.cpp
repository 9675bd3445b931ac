// SPDX-License-Identifier: BSD-3-Clause
// The stage as the host runs it: from a document to /meshes and /volumes, the same bytes for any number of
// threads.
#include "check.h"
#include "check.hpp"
#include "document.hpp"

#include <cstring>
#include <string>

namespace {

using conceg::must;
using conceg::view;
using scenes::document_of;

std::string digest(conceg_doc *doc, const char *group) {
  char hex[65] = "";
  must(conceg_doc_digest(doc, group, hex));
  return hex;
}

void meshes_are_written(const conceg::mesh::Tissue &tissue) {
  std::string meshes, volumes;
  for (const std::uint32_t threads : {1u, 2u, 3u}) {
    conceg_ctx *ctx = conceg_ctx_new();
    conceg_ctx_set_threads(ctx, threads);
    conceg_doc *doc = document_of(ctx, tissue);
    const conceg_status status = scenes::run_stage(ctx, doc, {"mesh.h_um=0.3"});
    CHECK_TEXT(conceg_ctx_error(ctx), "");
    CHECK_EQUAL(status, CONCEG_OK);
    if (threads == 1) {
      meshes = digest(doc, "/meshes"), volumes = digest(doc, "/volumes");
      const auto offset = view<std::uint64_t>(doc, "/meshes/face_offset");
      const auto vertex = view<double>(doc, "/meshes/vertex", 3),
                 origin = view<double>(doc, "/meshes/origin", 3);
      CHECK_EQUAL(offset.rows(), tissue.cells() + 1);
      CHECK_EQUAL(view<std::uint8_t>(doc, "/meshes/compartment").rows(), offset[tissue.cells()]);
      CHECK_EQUAL(view<std::uint64_t>(doc, "/meshes@crossings")[0], 0);
      CHECK(view<std::uint64_t>(doc, "/meshes@pairs_checked")[0] > 1000);
      const auto vertices = view<std::uint64_t>(doc, "/meshes/vertex_offset");
      for (std::size_t k = 0; k < tissue.cells(); k++) {
        CHECK(view<std::uint8_t>(doc, "/meshes/closed")[k] == 1);
        for (std::size_t v = vertices[k]; v < vertices[k + 1]; v += 97)
          for (int axis = 0; axis < 3; axis++) { // each value is the origin plus a float32
            const double relative = vertex.row(v)[axis] - origin.row(k)[axis];
            CHECK(static_cast<double>(static_cast<float>(relative)) == relative &&
                  origin.row(k)[axis] + relative == vertex.row(v)[axis]);
          }
      }
      double sum = 0;
      for (const double v : view<double>(doc, "/meshes/volume"))
        sum += v;
      CHECK_NEAR(view<double>(doc, "/meshes@icvf")[0], sum / 8000, 1e-6);
    } else {
      CHECK(digest(doc, "/meshes") == meshes);
      CHECK(digest(doc, "/volumes") == volumes);
    }
    must(conceg_doc_close(doc));
    conceg_ctx_free(ctx);
  }
}

void bad_input_is_refused(const conceg::mesh::Tissue &sound) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = document_of(ctx, sound);
  must(conceg_doc_close(doc));
  conceg::mesh::Tissue broken = sound;
  broken.parent[2] = 5; // later than itself
  doc = document_of(ctx, broken);
  CHECK(scenes::run_stage(ctx, doc, {}) != CONCEG_OK);
  CHECK(std::strstr(conceg_ctx_error(ctx), "parent") != nullptr);
  must(conceg_doc_close(doc));
  broken = sound;
  broken.point[3].x = 1e9;
  doc = document_of(ctx, broken);
  CHECK_EQUAL(scenes::run_stage(ctx, doc, {}), CONCEG_E_RANGE);
  CHECK(!conceg_doc_has(doc, "/meshes"));
  must(conceg_doc_close(doc));
  conceg_ctx_free(ctx);
}

void cancelling_stops() {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = document_of(ctx, scenes::forest(20, 2, 500, 3));
  conceg_ctx_set_progress(
      ctx, [](void *, const char *, std::uint64_t, std::uint64_t) { return 1; }, nullptr);
  CHECK_EQUAL(scenes::run_stage(ctx, doc, {}), CONCEG_E_CANCELLED);
  must(conceg_doc_close(doc));
  conceg_ctx_free(ctx);
}

void soma_alone_and_no_cells() {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg::mesh::Tissue tissue = scenes::empty_box(20);
  conceg_doc *doc = document_of(ctx, tissue);
  CHECK_EQUAL(scenes::run_stage(ctx, doc, {}), CONCEG_OK);
  CHECK_TEXT(conceg_ctx_error(ctx), "");
  must(conceg_doc_close(doc));
  scenes::add_cell(tissue, {10, 10, 10}, 5);
  doc = document_of(ctx, tissue);
  CHECK_EQUAL(scenes::run_stage(ctx, doc, {}), CONCEG_OK);
  CHECK_NEAR(view<double>(doc, "/meshes/volume")[0], 523.6, 3.0);
  must(conceg_doc_close(doc));
  conceg_ctx_free(ctx);
}

// What the volumes take is known and refused before the meshes are made.
void volumes_fit_the_memory() {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_ctx_set_memory(ctx, 4u << 20);
  conceg_doc *doc = document_of(ctx, scenes::forest(20, 2, 300, 3));
  CHECK_EQUAL(scenes::run_stage(ctx, doc, {"mesh.h_um=0.6", "mesh.volume_step_um=0.2"}), CONCEG_E_NOMEM);
  CHECK(std::strstr(conceg_ctx_error(ctx), "volume_step_um: voxels of 0.200 um take") != nullptr);
  CHECK(!conceg_doc_has(doc, "/meshes") && !conceg_doc_has(doc, "/volumes"));
  must(conceg_doc_close(doc));
  conceg_ctx_free(ctx);
}

void smooth_takes_a_single_cell() {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = document_of(ctx, scenes::forest(40, 2, 60, 3));
  CHECK(scenes::run_stage(ctx, doc, {"mesh.smooth=true", "mesh.h_um=0.4"}) != CONCEG_OK);
  CHECK(std::strstr(conceg_ctx_error(ctx),
                    conceg::vdb_available() ? "expected a single cell, got 2" : "no OpenVDB") != nullptr);
  must(conceg_doc_close(doc));
  if (conceg::vdb_available()) {
    doc = document_of(ctx, scenes::forest(60, 1, 100, 3));
    CHECK_EQUAL(scenes::run_stage(ctx, doc, {"mesh.smooth=true", "mesh.h_um=0.25", "mesh.volumes=false"}),
                CONCEG_OK);
    CHECK_TEXT(conceg_ctx_error(ctx), "");
    CHECK_EQUAL(view<std::uint8_t>(doc, "/meshes/closed")[0], 1);
    CHECK_EQUAL(view<std::uint64_t>(doc, "/meshes@crossings")[0], 0);
    CHECK(!conceg_doc_has(doc, "/volumes"));
    std::size_t soma = 0;
    for (const std::uint8_t code : view<std::uint8_t>(doc, "/meshes/compartment"))
      soma += code == 1;
    CHECK(soma > 1000 && soma < view<std::uint32_t>(doc, "/meshes/face", 3).rows());
    must(conceg_doc_close(doc));
  }
  conceg_ctx_free(ctx);
}

} // namespace

int main() {
  volumes_fit_the_memory();
  smooth_takes_a_single_cell();
  meshes_are_written(scenes::forest(20, 2, 500, 3));
  bad_input_is_refused(scenes::forest(20, 1, 50, 3));
  cancelling_stops();
  soma_alone_and_no_cells();
  return check_done();
}
