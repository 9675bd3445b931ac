/* SPDX-License-Identifier: BSD-3-Clause
 * The document: every type there and back, canonical bytes, order, dropping, carrying, wrong use. */
#define _XOPEN_SOURCE 700
#include "sample.h"

static conceg_array view(conceg_doc *doc, conceg_ctx *ctx, const char *path) {
  conceg_array array = {.size = sizeof array};
  if (conceg_doc_read(doc, path, &array) != CONCEG_OK) {
    fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    CHECK(!"the array can be read");
  }
  return array;
}

static void test_types(conceg_ctx *ctx) {
  char path[256];
  conceg_doc *doc = NULL, *back = NULL;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  uint8_t bytes[48];
  for (size_t i = 0; i < sizeof bytes; i++)
    bytes[i] = (uint8_t)(i * 37 + 1);
  for (int dtype = CONCEG_U8; dtype <= CONCEG_F64; dtype++)
    for (uint32_t rank = 0; rank <= 4; rank++) {
      char name[64];
      snprintf(name, sizeof name, "/x_test/%s_%u", conceg_dtype_name((conceg_dtype)dtype), rank);
      conceg_array array = {.size = sizeof array,
                            .dtype = (conceg_dtype)dtype,
                            .rank = rank,
                            .shape = {1, 1, 1, 1},
                            .data = bytes,
                            .unit = "mV"};
      if (rank) array.shape[rank - 1] = 6;
      CHECK_EQUAL(conceg_doc_write(doc, name, &array), CONCEG_OK);
      snprintf(name, sizeof name, "/x_test@%s_%u", conceg_dtype_name((conceg_dtype)dtype), rank);
      CHECK_EQUAL(conceg_doc_write(doc, name, &array), CONCEG_OK);
    }
  sample_put(doc, ctx, "/x_test/none", CONCEG_F32, 0, 3, NULL);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(path, "types.cgx")), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &back), CONCEG_OK);
  for (int dtype = CONCEG_U8; dtype <= CONCEG_F64; dtype++)
    for (uint32_t rank = 0; rank <= 4; rank++)
      for (int attribute = 0; attribute < 2; attribute++) {
        char name[64];
        snprintf(name, sizeof name, "/x_test%c%s_%u", attribute ? '@' : '/',
                 conceg_dtype_name((conceg_dtype)dtype), rank);
        const conceg_array array = view(back, ctx, name);
        CHECK_EQUAL(array.dtype, dtype);
        CHECK_EQUAL(array.rank, rank);
        CHECK_EQUAL(conceg_array_count(&array), rank ? 6 : 1);
        CHECK(memcmp(array.data, bytes, (rank ? 6 : 1) * conceg_dtype_bytes(array.dtype)) == 0);
        if (!attribute) CHECK_TEXT(array.unit, "mV");
      }
  const conceg_array none = view(back, ctx, "/x_test/none");
  CHECK_EQUAL(none.shape[0], 0);
  CHECK_EQUAL(none.shape[1], 3);
  CHECK(none.data == NULL);
  CHECK_EQUAL(conceg_doc_close(back), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

static void test_text(conceg_ctx *ctx) {
  conceg_doc *doc = sample_doc(ctx), *back = NULL;
  void *bytes = NULL;
  size_t count = 0;
  CHECK_EQUAL(conceg_doc_to_memory(doc, &bytes, &count), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_from_memory(ctx, bytes, count, &back), CONCEG_OK);
  conceg_free(bytes);
  const conceg_array notes = view(back, ctx, "/x_lab/deep/notes");
  CHECK_EQUAL(notes.dtype, CONCEG_TEXT);
  CHECK_EQUAL(notes.shape[0], 3);
  CHECK_TEXT(((const char *const *)notes.data)[0], "caf\xc3\xa9");
  CHECK_TEXT(((const char *const *)notes.data)[1], "");
  CHECK_TEXT(((const char *const *)notes.data)[2], "a longer one");
  const char *recipe = NULL;
  CHECK_EQUAL(conceg_doc_read_text(back, "/recipe", &recipe), CONCEG_OK);
  CHECK_TEXT(recipe, "conceg: 1\nseed: 1\n");
  CHECK_TEXT(view(back, ctx, "/cells/soma").unit, "um");
  CHECK_TEXT(view(back, ctx, "/domain@lo").unit, "um");
  CHECK_TEXT(view(back, ctx, "/statistics/cells/icvf").unit, "1");
  CHECK_EQUAL(conceg_doc_read_text(back, "/cells/soma", &recipe), CONCEG_E_FORMAT);
  conceg_doc_close(back);
  conceg_doc_close(doc);
}

/* Same content, same bytes: written in another order, after reading nothing, something, everything. */
static void test_bytes(conceg_ctx *ctx) {
  char a[256], b[256];
  conceg_doc *doc = sample_doc(ctx), *other = NULL;
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(a, "a.cgx")), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(b, "b.cgx")), CONCEG_OK);
  CHECK(sample_same(a, b));
  CHECK_EQUAL(conceg_doc_open(ctx, a, &other), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_save(other, b), CONCEG_OK);
  CHECK(sample_same(a, b));
  view(other, ctx, "/meshes/vertex");
  view(other, ctx, "/types/name");
  CHECK_EQUAL(conceg_doc_save(other, b), CONCEG_OK);
  CHECK(sample_same(a, b));
  CHECK_EQUAL(conceg_doc_save(other, a), CONCEG_OK); /* over the file that it reads from */
  CHECK(sample_same(a, b));
  const conceg_array soma = view(other, ctx, "/cells/soma");
  sample_put(other, ctx, "/cells/soma", CONCEG_F64, 3, 3, soma.data); /* from a view of itself */
  CHECK_EQUAL(conceg_doc_save(other, b), CONCEG_OK);
  CHECK(sample_same(a, b));
  CHECK_EQUAL(sample_files(), 3); /* types.cgx, a.cgx, b.cgx: no temporary file */
  double moved[9] = {0};
  sample_put(other, ctx, "/cells/soma", CONCEG_F64, 3, 3, moved);
  CHECK_EQUAL(conceg_doc_save(other, b), CONCEG_OK);
  CHECK(!sample_same(a, b));
  conceg_doc_close(other);
  conceg_doc_close(doc);
}

static void test_order(conceg_ctx *ctx) {
  static const char *const expected[] = {"/recipe",   "/domain/",      "/types/",     "/dictionary/",
                                         "/cells/",   "/bars/",        "/skeleton/",  "/spheres/",
                                         "/meshes/",  "/statistics/",  "/x_lab/",     "/@format",
                                         "/@version", "/@length_unit", "/@time_unit", "/@complete"};
  const uint64_t count = sizeof expected / sizeof *expected;
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_children(doc, "/"), count);
  for (uint64_t i = 0; i < count; i++)
    CHECK_TEXT(conceg_doc_child(doc, "/", i), expected[i]);
  CHECK(conceg_doc_child(doc, "/", count) == NULL);
  CHECK_TEXT(conceg_doc_child(doc, "/cells", 0), "/cells/id");
  CHECK_TEXT(conceg_doc_child(doc, "/cells/", 3), "/cells/soma");
  CHECK_TEXT(conceg_doc_child(doc, "/statistics/cells", 0), "/statistics/cells/count");
  CHECK_TEXT(conceg_doc_child(doc, "/domain", 0), "/domain@lo");
  conceg_doc_close(doc);
}

static void test_dropping(conceg_ctx *ctx) {
  conceg_doc *doc = sample_doc(ctx);
  CHECK(conceg_doc_has(doc, "/cells") && conceg_doc_has(doc, "/cells/") &&
        conceg_doc_has(doc, "/cells/soma"));
  CHECK(conceg_doc_has(doc, "/cells/soma@unit") && conceg_doc_has(doc, "/domain@lo") &&
        conceg_doc_has(doc, "/"));
  CHECK(!conceg_doc_has(doc, "/cells/soma/") && !conceg_doc_has(doc, "/cells/nothing") &&
        !conceg_doc_has(doc, "cells"));
  CHECK_EQUAL(conceg_doc_drop(doc, "/cells/soma"), CONCEG_OK);
  CHECK(!conceg_doc_has(doc, "/cells/soma") && conceg_doc_has(doc, "/cells/id"));
  CHECK_EQUAL(conceg_doc_drop(doc, "/cells"), CONCEG_OK);
  CHECK(!conceg_doc_has(doc, "/cells"));
  CHECK_EQUAL(conceg_doc_drop(doc, "/domain@lo"), CONCEG_OK);
  CHECK(!conceg_doc_has(doc, "/domain@lo") && conceg_doc_has(doc, "/domain@hi"));
  CHECK_EQUAL(conceg_doc_drop(doc, "/never/was"), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_drop(doc, "/"), CONCEG_E_PARAM);
  CHECK_EQUAL(conceg_doc_drop(doc, "/@format"), CONCEG_E_PARAM);
  conceg_doc_close(doc);
}

static void test_new_array(conceg_ctx *ctx) {
  conceg_doc *doc = NULL;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  const uint64_t shape[2] = {1000, 3};
  void *storage = NULL;
  CHECK_EQUAL(conceg_doc_new_array(doc, "/network/position", CONCEG_F64, 2, shape, &storage), CONCEG_OK);
  double *position = storage;
  int zeroed = 1;
  for (int i = 0; i < 3000; i++)
    zeroed &= position[i] == 0;
  CHECK(zeroed);
  position[2999] = 7;
  const conceg_array array = view(doc, ctx, "/network/position");
  CHECK(array.data == storage && ((const double *)array.data)[2999] == 7);
  CHECK_TEXT(array.unit, "um");
  CHECK_EQUAL(conceg_doc_new_array(doc, "/x_lab/text", CONCEG_TEXT, 1, shape, &storage), CONCEG_E_PARAM);
  conceg_doc_close(doc);
}

/* A failed call changes nothing and says why. */
static void test_wrong_use(conceg_ctx *ctx) {
  static const char *const bad[] = {
      "",      "cells", "/",   "//a",    "/a/",    "/a//b",     "/a b",
      "/../a", "/./a",  "/a@", "/a@b@c", "/a@b/c", "/@version", "/1/2/3/4/5/6/7/8/9/10/11/12/13/14/15/16/17"};
  const double one = 1;
  conceg_doc *doc = NULL;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  const uint64_t before = conceg_doc_children(doc, "/");
  conceg_array array = {.size = sizeof array, .dtype = CONCEG_F64, .data = &one};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    const conceg_status status = conceg_doc_write(doc, bad[i], &array);
    if (status != CONCEG_E_PARAM) fprintf(stderr, "path \"%s\": %s\n", bad[i], conceg_status_name(status));
    CHECK_EQUAL(status, CONCEG_E_PARAM);
  }
  conceg_array wrong = array;
  wrong.rank = 5;
  CHECK_EQUAL(conceg_doc_write(doc, "/a/b", &wrong), CONCEG_E_PARAM);
  wrong = array, wrong.dtype = 0;
  CHECK_EQUAL(conceg_doc_write(doc, "/a/b", &wrong), CONCEG_E_PARAM);
  wrong = array, wrong.rank = 2, wrong.shape[0] = wrong.shape[1] = UINT64_MAX / 2;
  CHECK_EQUAL(conceg_doc_write(doc, "/a/b", &wrong), CONCEG_E_PARAM);
  wrong = array, wrong.data = NULL;
  CHECK_EQUAL(conceg_doc_write(doc, "/a/b", &wrong), CONCEG_E_PARAM);
  wrong = array, wrong.size = 0;
  CHECK_EQUAL(conceg_doc_write(doc, "/a/b", &wrong), CONCEG_E_USAGE);
  CHECK_EQUAL(conceg_doc_write_text(doc, "/a/b", "\xff\xfe"), CONCEG_E_PARAM);
  CHECK_EQUAL(conceg_doc_write_text(doc, "/cells/soma@note", "no such dataset"), CONCEG_E_MISSING);
  const uint64_t huge[1] = {(uint64_t)1 << 62};
  void *storage = NULL;
  CHECK(conceg_doc_new_array(doc, "/a/b", CONCEG_U8, 1, huge, &storage) != CONCEG_OK);
  CHECK_EQUAL(conceg_doc_children(doc, "/"), before);
  CHECK_EQUAL(conceg_doc_write(doc, "/a/b", &array), CONCEG_OK);
  CHECK_EQUAL(conceg_doc_write(doc, "/a", &array), CONCEG_E_PARAM);     /* a group */
  CHECK_EQUAL(conceg_doc_write(doc, "/a/b/c", &array), CONCEG_E_PARAM); /* below a dataset */
  CHECK_EQUAL(conceg_doc_read(doc, "/a", &array), CONCEG_E_MISSING);
  CHECK_EQUAL(conceg_doc_read(doc, "/nothing", &array), CONCEG_E_MISSING);
  CHECK(strstr(conceg_ctx_error(ctx), "/nothing") != NULL);
  CHECK_EQUAL(conceg_doc_close(NULL), CONCEG_OK);
  conceg_doc_close(doc);
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  test_types(ctx);
  test_text(ctx);
  test_bytes(ctx);
  test_order(ctx);
  test_dropping(ctx);
  test_new_array(ctx);
  test_wrong_use(ctx);
  conceg_ctx_free(ctx);
  sample_clean();
  return check_done();
}
