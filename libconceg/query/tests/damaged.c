/* SPDX-License-Identifier: BSD-3-Clause
 * Documents with random damage in the arrays that a substrate reads: each is refused with a line that names
 * an array, or opens, and then every view is read to its ends and the query answers. Under a sanitizer this
 * is the test that nothing read from a file leads out of memory. */
#include "conceg/query.h"

#include "shapes.h"

enum { ROUNDS = 1500 };

static conceg_rng rng;

static const char *const paths[] = {
    "/domain@lo",         "/domain@hi",     "/domain@periodic",      "/types/class",
    "/cells/id",          "/cells/type",    "/cells/soma",           "/cells/radius",
    "/meshes/cell",       "/meshes/origin", "/meshes/face_offset",   "/meshes/vertex_offset",
    "/meshes/vertex",     "/meshes/face",   "/meshes/compartment",   "/meshes/volume",
    "/meshes/closed",     "/meshes/form",   "/skeleton/cell_offset", "/skeleton/parent",
    "/skeleton/position", "/volumes/label", "/volumes/leaf_origin"};
enum { PATHS = sizeof paths / sizeof *paths };

static conceg_doc *whole(conceg_ctx *ctx, const shapes *s) {
  conceg_doc *doc = shapes_doc(ctx, s);
  static const uint64_t offset[3] = {0, 2, 3};
  static const double position[3][3] = {{5, 5, 5}, {6, 5, 5}, {15, 15, 15}};
  static const float radius[3] = {1, 1, 1};
  static const int64_t parent[3] = {-1, 0, -1};
  static const uint8_t kind[3] = {3, 3, 7};
  static const int32_t leaf[1][3] = {{0, 8, 16}};
  static uint32_t label[1][512];
  label[0][5] = 2;
  shapes_put(doc, "/skeleton/cell_offset", CONCEG_U64, 3, 0, offset);
  shapes_put(doc, "/skeleton/position", CONCEG_F64, 3, 3, position);
  shapes_put(doc, "/skeleton/radius", CONCEG_F32, 3, 0, radius);
  shapes_put(doc, "/skeleton/target_radius", CONCEG_F32, 3, 0, radius);
  shapes_put(doc, "/skeleton/parent", CONCEG_I64, 3, 0, parent);
  shapes_put(doc, "/skeleton/kind", CONCEG_U8, 3, 0, kind);
  shapes_put(doc, "/volumes/leaf_origin", CONCEG_I32, 1, 3, leaf);
  shapes_put(doc, "/volumes/label", CONCEG_U32, 1, 512, label);
  return doc;
}

/* Bytes that are likely to do harm: extremes, no numbers, off by one, noise. */
static void harm(unsigned char *value, conceg_dtype dtype) {
  static const double numbers[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e9, 1e-300, -1, 0, 23.999};
  const size_t bytes = conceg_dtype_bytes(dtype);
  const uint64_t choice = conceg_rng_below(&rng, 5);
  if ((dtype == CONCEG_F64 || dtype == CONCEG_F32) && choice < 4) {
    const double x = numbers[conceg_rng_below(&rng, sizeof numbers / sizeof *numbers)];
    const float y = x > 1e30 ? INFINITY : x < -1e30 ? -INFINITY : (float)x;
    memcpy(value, dtype == CONCEG_F64 ? (const void *)&x : (const void *)&y, bytes);
    return;
  }
  switch (choice) {
  case 0:
    memset(value, 0xff, bytes);
    return;
  case 1:
    memset(value, 0, bytes);
    return;
  case 2:
    value[0]++;
    return;
  case 3:
    value[bytes - 1] ^= 0x80;
    return;
  default:
    value[conceg_rng_below(&rng, bytes)] ^= (unsigned char)(1u << conceg_rng_below(&rng, 8));
  }
}

/* One array: some values changed, rows lost, another type, or gone. */
static void damage(conceg_doc *doc, const char *path) {
  conceg_array array = {.size = sizeof array};
  if (conceg_doc_read(doc, path, &array) != CONCEG_OK) return;
  const uint64_t values = conceg_array_count(&array), choice = conceg_rng_below(&rng, 10);
  if (!values || choice == 0) {
    CHECK_EQUAL(conceg_doc_drop(doc, path), CONCEG_OK);
    return;
  }
  if (array.dtype == CONCEG_TEXT || choice == 1) {
    array.shape[0]--;
    CHECK_EQUAL(conceg_doc_write(doc, path, &array), CONCEG_OK);
    return;
  }
  const size_t width = conceg_dtype_bytes(array.dtype);
  unsigned char *copy = malloc(values * width);
  if (!copy) exit(1);
  memcpy(copy, array.data, values * width);
  for (uint64_t i = conceg_rng_below(&rng, 3) + 1; i; i--)
    harm(copy + width * conceg_rng_below(&rng, values), array.dtype);
  array.data = copy;
  CHECK_EQUAL(conceg_doc_write(doc, path, &array), CONCEG_OK);
  free(copy);
}

/* Reads every view to its ends. */
static double read_all(const conceg_substrate *substrate) {
  double sum = 0;
  for (uint64_t i = 0; i < conceg_substrate_cells(substrate); i++) {
    conceg_cell_view cell = {.size = sizeof cell};
    conceg_skeleton_view skeleton = {.size = sizeof skeleton};
    uint64_t row = 0;
    CHECK_EQUAL(conceg_substrate_cell(substrate, i, &cell), CONCEG_OK);
    CHECK_EQUAL(conceg_substrate_skeleton(substrate, i, &skeleton), CONCEG_OK);
    CHECK_EQUAL(conceg_substrate_find_cell(substrate, cell.id, &row), CONCEG_OK);
    CHECK_EQUAL(row, i);
    sum += (double)strlen(cell.type_name) + (double)strlen(cell.class_name);
    for (uint64_t p = 0; p < skeleton.count; p++)
      sum += skeleton.position[3 * p + 2] +
             (skeleton.parent[p] < 0 ? 0 : skeleton.position[3 * skeleton.parent[p]]);
  }
  for (uint64_t i = 0; i < conceg_substrate_meshes(substrate); i++) {
    conceg_mesh_view mesh = {.size = sizeof mesh};
    conceg_cell_view cell = {.size = sizeof cell};
    CHECK_EQUAL(conceg_substrate_mesh(substrate, i, &mesh), CONCEG_OK);
    CHECK_EQUAL(conceg_substrate_cell(substrate, mesh.cell, &cell), CONCEG_OK);
    for (uint64_t f = 0; f < mesh.face_count; f++)
      for (int k = 0; k < 3; k++)
        sum += mesh.vertex[3 * (uint64_t)mesh.face[3 * f + (uint64_t)k] + 2] + mesh.compartment[f];
  }
  conceg_volumes_view volumes = {.size = sizeof volumes};
  if (conceg_substrate_volumes(substrate, &volumes) == CONCEG_OK)
    for (uint64_t i = 0; volumes.label && i < 512 * volumes.leaf_count; i++)
      sum += volumes.label[i];
  return sum;
}

/* Points and rays; every answer is a cell of the substrate or none. */
static void ask(const conceg_substrate *substrate, const conceg_query *query) {
  for (int i = 0; i < 20; i++) {
    double point[3], direction[3] = {0, 0, 0}, lo[3], hi[3];
    const double length = 30;
    uint8_t periodic[3];
    int64_t cell = -9;
    conceg_hit hit;
    conceg_substrate_box(substrate, lo, hi, periodic);
    direction[i % 3] = i % 2 ? 1 : -1;
    for (int k = 0; k < 3; k++)
      point[k] = lo[k] + (hi[k] - lo[k]) * conceg_rng_uniform(&rng);
    const int64_t cells = (int64_t)conceg_substrate_cells(substrate);
    if (conceg_query_locate(query, 1, point, &cell, NULL) == CONCEG_OK) CHECK(cell >= -1 && cell < cells);
    if (conceg_query_intersect(query, 1, point, direction, &length, &hit) == CONCEG_OK)
      CHECK(hit.cell >= -1 && hit.cell < cells);
  }
}

int main(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  shapes s;
  int refused = 0, opened = 0, asked = 0;
  rng = conceg_rng_stream(3, "damaged", 0);
  conceg_ctx_set_threads(ctx, 1);
  conceg_ctx_set_memory(ctx, 16u << 20); /* of images: a stretched face fills it at once */
  shapes_new(&s, 24);
  shapes_begin(&s, 5, 5, 5, 3);
  shapes_sphere(&s, 1, 5, 5, 5, 3, 0, CONCEG_SOMA);
  shapes_end(&s);
  shapes_begin(&s, 15, 15, 23, 3);
  shapes_sphere(&s, 1, 15, 15, 23, 3, 0, CONCEG_AXON);
  shapes_end(&s);
  for (int round = 0; round < ROUNDS; round++) {
    conceg_doc *doc = whole(ctx, &s);
    conceg_substrate *substrate = NULL;
    conceg_query *query = NULL;
    for (uint64_t i = conceg_rng_below(&rng, 2) + 1; i; i--)
      damage(doc, paths[conceg_rng_below(&rng, PATHS)]);
    conceg_ctx_clear_error(ctx);
    if (conceg_substrate_open(doc, &substrate) != CONCEG_OK) {
      CHECK(substrate == NULL && strchr(conceg_ctx_error(ctx), '/') != NULL);
      refused++;
    } else {
      opened++;
      CHECK(!isnan(read_all(substrate)));
      if (conceg_query_new(ctx, substrate, &query) == CONCEG_OK)
        asked++, ask(substrate, query);
      else
        CHECK(query == NULL && strchr(conceg_ctx_error(ctx), '/') != NULL);
    }
    conceg_query_free(query);
    conceg_substrate_free(substrate);
    CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  }
  printf("%d documents: %d refused, %d opened, %d of these with a query\n", ROUNDS, refused, opened, asked);
  CHECK(refused > ROUNDS / 5 && asked > ROUNDS / 10);
  shapes_free(&s);
  conceg_ctx_free(ctx);
  return check_done();
}
