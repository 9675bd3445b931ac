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
    conceg_cell_view cell = {.size = sizeof cell};
    conceg_skeleton_view skeleton = {.size = sizeof skeleton};
    uint64_t row = 0;
    if (conceg_substrate_mesh(substrate, 1, &mesh) != CONCEG_OK || mesh.vertex[3] != 11) return (void *)1;
    if (conceg_substrate_find_cell(substrate, 13, &row) != CONCEG_OK || row != 2) return (void *)1;
    if (conceg_substrate_cell(substrate, row, &cell) != CONCEG_OK || cell.id != 13) return (void *)1;
    if (conceg_substrate_skeleton(substrate, 0, &skeleton) != CONCEG_OK || skeleton.count != 3)
      return (void *)1;
  }
  return NULL;
}

static void look_from_threads(conceg_substrate *substrate) {
  pthread_t thread[4];
  for (int i = 0; i < 4; i++)
    pthread_create(&thread[i], NULL, look, substrate);
  for (int i = 0; i < 4; i++) {
    void *failed = NULL;
    pthread_join(thread[i], &failed);
    CHECK(failed == NULL);
  }
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
  look_from_threads(substrate);
  conceg_substrate_free(substrate);
  conceg_substrate_free(NULL);
}

/* Every optional array of the schema that a view shows. */
static void put_more(conceg_ctx *ctx, conceg_doc *doc) {
  static uint32_t label[2 * 512];
  static float distance[2 * 512];
  label[512 + 7] = 3, distance[512 + 7] = -0.25f;
  PUT("/skeleton/branch", CONCEG_U32, uint32_t, 0, 0, 0, 1, 0);
  PUT("/meshes/component", CONCEG_U32, uint32_t, 0, 0, 0, 0, 0, 0, 0, 1, 1);
  PUT("/meshes/section", CONCEG_U32, uint32_t, 0, 4294967295u, 0, 0, 0, 0, 0, 0, 5);
  PUT("/meshes/genus", CONCEG_I64, int64_t, 0, 0, 2);
  PUT("/meshes/closed", CONCEG_U8, uint8_t, 0, 1, 0);
  PUT("/meshes/min_gap", CONCEG_F64, double, 0, 0.1, 0.05);
  PUT("/volumes@origin", CONCEG_F64, double, 0, 0.5, 0.5, 0.5);
  PUT("/volumes@spacing", CONCEG_F64, double, 0, 1, 1, 1);
  PUT("/volumes@shape", CONCEG_U64, uint64_t, 0, 40, 40, 40);
  PUT("/volumes/leaf_origin", CONCEG_I32, int32_t, 3, 0, 0, 0, 0, 8, -8);
  sample_put(doc, ctx, "/volumes/label", CONCEG_U32, 2, 512, label);
  sample_put(doc, ctx, "/volumes/distance", CONCEG_F32, 2, 512, distance);
}

static void test_more_views(const conceg_substrate *substrate) {
  conceg_type_view type = {.size = sizeof type};
  CHECK_EQUAL(conceg_substrate_types(substrate), 2);
  CHECK_EQUAL(conceg_substrate_type(substrate, 0, &type), CONCEG_OK);
  CHECK_TEXT(type.name, "L4 pyramidal");
  CHECK_TEXT(type.class_name, "pyramidal");
  CHECK_EQUAL(conceg_substrate_type(substrate, 2, &type), CONCEG_E_RANGE);
  uint64_t cell = 9;
  CHECK_EQUAL(conceg_substrate_find_cell(substrate, 12, &cell), CONCEG_OK);
  CHECK_EQUAL(cell, 1);
  CHECK_EQUAL(conceg_substrate_find_cell(substrate, 14, &cell), CONCEG_E_MISSING);
  CHECK_EQUAL(conceg_substrate_find_cell(substrate, 0, &cell), CONCEG_E_MISSING);
  conceg_skeleton_view skeleton = {.size = sizeof skeleton};
  CHECK_EQUAL(conceg_substrate_skeleton(substrate, 0, &skeleton), CONCEG_OK);
  CHECK(skeleton.target_radius[2] == 0.4f && skeleton.branch[2] == 1);
  conceg_mesh_view mesh = {.size = sizeof mesh};
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 1, &mesh), CONCEG_OK);
  CHECK(mesh.first_face == 4 && mesh.component[2] == 1 && mesh.section[3] == 5 && mesh.origin[2] == 30);
  CHECK(mesh.genus == 2 && mesh.closed == 0 && mesh.min_gap == 0.05);
  CHECK_TEXT(mesh.form, "closed");
  conceg_volumes_view volumes = {.size = sizeof volumes};
  CHECK_EQUAL(conceg_substrate_volumes(substrate, &volumes), CONCEG_OK);
  CHECK(volumes.leaf_count == 2 && volumes.leaf_origin[5] == -8 && volumes.shape[1] == 40);
  CHECK(volumes.label[519] == 3 && volumes.distance[519] == -0.25f && volumes.origin[0] == 0.5);
  CHECK(volumes.spacing[2] == 1 && volumes.size == sizeof volumes);
}

/* By one call from a file that is gone afterwards: nothing is read later. */
static void test_file(conceg_ctx *ctx) {
  char path[256];
  conceg_doc *doc = sample_doc(ctx);
  conceg_substrate *substrate = NULL;
  put_more(ctx, doc);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(path, "more.cgx")), CONCEG_OK);
  conceg_doc_close(doc);
  CHECK_EQUAL(conceg_substrate_open_file(ctx, path, &substrate), CONCEG_OK);
  CHECK_EQUAL(unlink(path), 0);
  if (!substrate) return;
  test_more_views(substrate);
  look_from_threads(substrate);
  conceg_substrate_free(substrate);
  CHECK_EQUAL(conceg_substrate_open_file(ctx, path, &substrate), CONCEG_E_IO);
  CHECK(substrate == NULL && strstr(conceg_ctx_error(ctx), "more.cgx") != NULL);
  CHECK_EQUAL(conceg_substrate_open_file(ctx, NULL, &substrate), CONCEG_E_USAGE);
}

/* What is not in the document is 0 or NULL. */
static void test_absent(conceg_ctx *ctx) {
  conceg_doc *doc = sample_doc(ctx);
  conceg_substrate *substrate = NULL;
  CHECK_EQUAL(conceg_doc_drop(doc, "/meshes/form"), CONCEG_OK);
  CHECK_EQUAL(conceg_substrate_open(doc, &substrate), CONCEG_OK);
  conceg_doc_close(doc);
  conceg_mesh_view mesh = {.size = sizeof mesh};
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 1, &mesh), CONCEG_OK);
  CHECK(!mesh.form && !mesh.component && !mesh.section && !mesh.closed && mesh.min_gap == 0 &&
        mesh.genus == 0);
  conceg_skeleton_view skeleton = {.size = sizeof skeleton};
  CHECK_EQUAL(conceg_substrate_skeleton(substrate, 0, &skeleton), CONCEG_OK);
  CHECK(skeleton.branch == NULL);
  conceg_volumes_view volumes = {.size = sizeof volumes};
  CHECK_EQUAL(conceg_substrate_volumes(substrate, &volumes), CONCEG_E_MISSING);
  conceg_substrate_free(substrate);
  CHECK_TEXT(conceg_compartment_name(CONCEG_APICAL_DENDRITE), "apical dendrite");
  CHECK_TEXT(conceg_compartment_name(CONCEG_ECS), "extracellular");
  CHECK(conceg_compartment_name(5) == NULL && conceg_compartment_name(0xffffffffu) == NULL);
}

/* Views of an older caller, which end earlier, and of a newer one, which have members that this library does
 * not know: nothing is written past `size`, the rest is cleared. */
static void test_sizes(conceg_ctx *ctx) {
  conceg_doc *doc = sample_doc(ctx);
  conceg_substrate *substrate = NULL;
  CHECK_EQUAL(conceg_substrate_open(doc, &substrate), CONCEG_OK);
  conceg_doc_close(doc);
  union {
    conceg_mesh_view view;
    unsigned char byte[sizeof(conceg_mesh_view) + 64];
  } room;
  memset(&room, 0xee, sizeof room);
  room.view.size = offsetof(conceg_mesh_view, volume);
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 0, &room.view), CONCEG_OK);
  CHECK(room.view.face_count == 4 && room.view.compartment[3] == 3);
  CHECK_EQUAL(room.view.size, offsetof(conceg_mesh_view, volume));
  CHECK_EQUAL(room.byte[offsetof(conceg_mesh_view, volume)], 0xee);
  memset(&room, 0xee, sizeof room);
  room.view.size = sizeof room;
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 0, &room.view), CONCEG_OK);
  CHECK_NEAR(room.view.volume, 1.0 / 6, 1e-15);
  CHECK_EQUAL(room.view.size, sizeof room);
  for (size_t i = sizeof(conceg_mesh_view); i < sizeof room; i++)
    CHECK_EQUAL(room.byte[i], 0);
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 0, NULL), CONCEG_E_USAGE);
  room.view.size = 4;
  CHECK_EQUAL(conceg_substrate_mesh(substrate, 0, &room.view), CONCEG_E_USAGE);
  conceg_substrate_free(substrate);
}

static void refuse(conceg_ctx *ctx, conceg_doc *doc, conceg_status status, const char *path) {
  conceg_substrate *substrate = NULL;
  CHECK_EQUAL(conceg_substrate_open(doc, &substrate), status);
  CHECK(substrate == NULL);
  if (!strstr(conceg_ctx_error(ctx), path)) fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  CHECK(strstr(conceg_ctx_error(ctx), path) != NULL);
  conceg_doc_close(doc);
}

/* One damage each; the refusal names where. */
#define REFUSE(where, ...)                                                                                   \
  do {                                                                                                       \
    conceg_doc *doc = sample_doc(ctx);                                                                       \
    put_more(ctx, doc);                                                                                      \
    __VA_ARGS__;                                                                                             \
    refuse(ctx, doc, CONCEG_E_FORMAT, where);                                                                \
  } while (0)

static void test_refusals(conceg_ctx *ctx) {
  conceg_doc *missing = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_drop(missing, "/domain"), CONCEG_OK);
  refuse(ctx, missing, CONCEG_E_MISSING, "/domain");
  missing = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_drop(missing, "/meshes/face"), CONCEG_OK);
  refuse(ctx, missing, CONCEG_E_MISSING, "/meshes/face");
  missing = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_drop(missing, "/cells"), CONCEG_OK);
  refuse(ctx, missing, CONCEG_E_FORMAT, "/skeleton/cell_offset");

  REFUSE("/domain@hi[1]", PUT("/domain@hi", CONCEG_F64, double, 0, 40, 0, 40));
  REFUSE("/domain@lo[2]", PUT("/domain@lo", CONCEG_F64, double, 0, 0, 0, NAN));
  REFUSE("/domain@hi[0]", PUT("/domain@hi", CONCEG_F64, double, 0, INFINITY, 40, 40));
  REFUSE("/domain@periodic[2]", PUT("/domain@periodic", CONCEG_U8, uint8_t, 0, 1, 1, 2));
  REFUSE("/cells/type[1]", PUT("/cells/type", CONCEG_U32, uint32_t, 0, 0, 9, 0));
  REFUSE("/cells/id[2]", PUT("/cells/id", CONCEG_U64, uint64_t, 0, 11, 12, 11));
  REFUSE("/cells/soma[1,2]", PUT("/cells/soma", CONCEG_F64, double, 3, 1, 2, 3, 4, 5, NAN, 7, 8, 9));
  REFUSE("/cells/radius[0]", PUT("/cells/radius", CONCEG_F32, float, 0, INFINITY, 4, 0));
  REFUSE("/types/class", PUT("/types/class", CONCEG_TEXT, char *, 0, (char *)"pyramidal"));

  REFUSE("/skeleton/cell_offset[2]", PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, 3, 2, 4));
  REFUSE("/skeleton/cell_offset[0]", PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 1, 3, 4, 4));
  REFUSE("/skeleton/position", PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, 3, 4, UINT64_MAX));
  REFUSE("/skeleton/parent[2]", PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 0, 2, -1));
  REFUSE("/skeleton/parent[3]", PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 0, 1, INT64_MIN));
  REFUSE("/skeleton/radius", PUT("/skeleton/radius", CONCEG_F32, float, 0, 1, 1, 1));
  REFUSE("/skeleton/radius[3]", PUT("/skeleton/radius", CONCEG_F32, float, 0, 1, 1, 1, NAN));
  REFUSE("/skeleton/branch", PUT("/skeleton/branch", CONCEG_U32, uint32_t, 0, 0, 0));

  REFUSE("/meshes/cell[1]", PUT("/meshes/cell", CONCEG_U32, uint32_t, 0, 0, 3));
  REFUSE("/meshes/vertex_offset[2]", PUT("/meshes/vertex_offset", CONCEG_U64, uint64_t, 0, 0, 9, 8));
  REFUSE("/meshes/face_offset", PUT("/meshes/face_offset", CONCEG_U64, uint64_t, 0, 0, 4));
  REFUSE("/meshes/face", PUT("/meshes/face_offset", CONCEG_U64, uint64_t, 0, 0, 4, 1ull << 62));
  REFUSE("/meshes/vertex[0,1]", PUT("/meshes/vertex", CONCEG_F64, double, 3, 1, NAN, 3, 2, 2, 3, 1, 3, 3, 1,
                                    2, 4, 10, 20, 30, 11, 20, 30, 10, 21, 30, 10, 20, 31));
  REFUSE("/meshes/face[7,1]", PUT("/meshes/face", CONCEG_U32, uint32_t, 3, 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3,
                                  0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 4, 3));
  REFUSE("/meshes/face", PUT("/meshes/face", CONCEG_U64, uint64_t, 3, 0, 2, 1));
  REFUSE("/meshes/compartment", PUT("/meshes/compartment", CONCEG_U8, uint8_t, 0, 1, 1));
  REFUSE("/meshes/min_gap[1]", PUT("/meshes/min_gap", CONCEG_F64, double, 0, 1, NAN));
  REFUSE("/meshes/form", PUT("/meshes/form", CONCEG_TEXT, char *, 0, (char *)"closed"));

  static uint32_t label[2 * 512];
  label[600] = 4; /* three cells: labels 0 to 3 */
  REFUSE("/volumes/label[1,88]", sample_put(doc, ctx, "/volumes/label", CONCEG_U32, 2, 512, label));
  REFUSE("/volumes/label", sample_put(doc, ctx, "/volumes/label", CONCEG_U32, 1, 512, label));
  REFUSE("/volumes@shape", PUT("/volumes@shape", CONCEG_U64, uint64_t, 0, 40, 40));
}

static void keep_line(void *user, conceg_log_level level, const char *line) {
  if (level == CONCEG_LOG_WARNING) snprintf(user, 200, "%s", line);
}

/* Meshes of a skeleton that another tool has changed (CGX-070): one who opens them is told. */
static void test_origins(conceg_ctx *ctx) {
  char hex[65], row[80], line[200] = "";
  const char *const rows[] = {row};
  const conceg_array made_from = {sizeof made_from, CONCEG_TEXT, 1, 0, {1}, rows, NULL};
  conceg_doc *doc = sample_doc(ctx);
  conceg_substrate *substrate = NULL;
  CHECK_EQUAL(conceg_doc_digest(doc, "/skeleton", hex), CONCEG_OK);
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, keep_line, line);
  for (int changed = 0; changed < 2; changed++) {
    hex[0] = changed ? (hex[0] == '0' ? '1' : '0') : hex[0];
    snprintf(row, sizeof row, "skeleton=%s", hex);
    CHECK_EQUAL(conceg_doc_write(doc, "/meshes@made_from", &made_from), CONCEG_OK);
    CHECK_EQUAL(conceg_substrate_open(doc, &substrate), CONCEG_OK);
    conceg_substrate_free(substrate);
    CHECK_EQUAL(strlen(line) > 0, changed);
  }
  CHECK(strstr(line, "/meshes was made from another /skeleton") != NULL);
  conceg_ctx_set_log(ctx, CONCEG_LOG_WARNING, NULL, NULL);
  conceg_doc_close(doc);
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  test_views(ctx);
  test_file(ctx);
  test_origins(ctx);
  test_absent(ctx);
  test_sizes(ctx);
  test_refusals(ctx);
  sample_clean();
  conceg_ctx_free(ctx);
  return check_done();
}
