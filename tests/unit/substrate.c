/* SPDX-License-Identifier: BSD-3-Clause
 * The substrate handle: what it shows after the document is closed, from many threads, and what it refuses.
 */
#define _XOPEN_SOURCE 700
#include "sample.h"

#include "conceg/model.h"

#include <pthread.h>

static void *look(void *user) {
  const conceg_substrate *substrate = user;
  for (int round = 0; round < 1000; round++) {
    conceg_mesh_view mesh = {.size = sizeof mesh};
    if (conceg_substrate_mesh(substrate, 1, &mesh) != CONCEG_OK || mesh.vertex[3] != 11) return (void *)1;
  }
  return NULL;
}

static void test_views(conceg_ctx *ctx) {
  conceg_doc *doc = sample_doc(ctx);
  conceg_substrate *substrate = NULL;
  CHECK_EQUAL(conceg_substrate_open(doc, &substrate), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  double lo[3], hi[3];
  uint8_t periodic[3];
  conceg_substrate_box(substrate, lo, hi, periodic);
  CHECK(lo[0] == 0 && hi[2] == 40 && periodic[1] == 1);
  CHECK_EQUAL(conceg_substrate_cells(substrate), 3);
  CHECK_EQUAL(conceg_substrate_meshes(substrate), 2);
  conceg_cell_view cell = {.size = sizeof cell};
  CHECK_EQUAL(conceg_substrate_cell(substrate, 1, &cell), CONCEG_OK);
  CHECK_EQUAL(cell.id, 12);
  CHECK_TEXT(cell.type_name, "astrocyte");
  CHECK(cell.soma[2] == 30 && cell.soma_radius == 4);
  CHECK_EQUAL(conceg_substrate_cell(substrate, 3, &cell), CONCEG_E_RANGE);
  conceg_skeleton_view skeleton = {.size = sizeof skeleton};
  CHECK_EQUAL(conceg_substrate_skeleton(substrate, 0, &skeleton), CONCEG_OK);
  CHECK_EQUAL(skeleton.count, 3);
  CHECK(skeleton.position[6] == 2 && skeleton.parent[2] == 1 && skeleton.kind[0] == 3);
  CHECK_EQUAL(conceg_substrate_skeleton(substrate, 2, &skeleton), CONCEG_OK);
  CHECK(skeleton.count == 0 && skeleton.position == NULL);
  conceg_mesh_view mesh = {.size = sizeof mesh};
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 0, &mesh), CONCEG_OK);
  CHECK(mesh.vertex_count == 4 && mesh.face_count == 4 && mesh.face[11] == 3 && mesh.compartment[3] == 3);
  CHECK_NEAR(mesh.volume, 1.0 / 6, 1e-15);
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 2, &mesh), CONCEG_E_RANGE);
  mesh.size = 0;
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 0, &mesh), CONCEG_E_USAGE);
  pthread_t thread[4];
  for (int i = 0; i < 4; i++)
    pthread_create(&thread[i], NULL, look, substrate);
  for (int i = 0; i < 4; i++) {
    void *failed = NULL;
    pthread_join(thread[i], &failed);
    CHECK(failed == NULL);
  }
  conceg_substrate_free(substrate);
  conceg_substrate_free(NULL);
}

static void refuse(conceg_ctx *ctx, conceg_doc *doc, conceg_status status, const char *path) {
  conceg_substrate *substrate = NULL;
  CHECK_EQUAL(conceg_substrate_open(doc, &substrate), status);
  CHECK(substrate == NULL);
  if (!strstr(conceg_ctx_error(ctx), path)) fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  CHECK(strstr(conceg_ctx_error(ctx), path) != NULL);
  conceg_doc_close(doc);
}

static void test_refusals(conceg_ctx *ctx) {
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_drop(doc, "/domain"), CONCEG_OK);
  refuse(ctx, doc, CONCEG_E_MISSING, "/domain");
  doc = sample_doc(ctx);
  PUT("/cells/type", CONCEG_U32, uint32_t, 0, 0, 9, 0);
  refuse(ctx, doc, CONCEG_E_FORMAT, "/cells/type[1]");
  doc = sample_doc(ctx);
  PUT("/types/class", CONCEG_TEXT, char *, 0, (char *)"pyramidal");
  refuse(ctx, doc, CONCEG_E_FORMAT, "/types/class");
  doc = sample_doc(ctx);
  PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, 3, 2, 4);
  refuse(ctx, doc, CONCEG_E_FORMAT, "/skeleton/cell_offset[2]");
  doc = sample_doc(ctx);
  PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 0, 2, -1);
  refuse(ctx, doc, CONCEG_E_FORMAT, "/skeleton/parent[2]");
  doc = sample_doc(ctx);
  PUT("/skeleton/radius", CONCEG_F32, float, 0, 1, 1, 1);
  refuse(ctx, doc, CONCEG_E_FORMAT, "/skeleton/radius");
  doc = sample_doc(ctx);
  PUT("/meshes/face", CONCEG_U32, uint32_t, 3, 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 2, 1, 0, 1, 3, 0, 3, 2,
      1, 4, 3);
  refuse(ctx, doc, CONCEG_E_FORMAT, "/meshes/face[7,1]");
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  test_views(ctx);
  test_refusals(ctx);
  conceg_ctx_free(ctx);
  return check_done();
}
