/* SPDX-License-Identifier: BSD-3-Clause
 * The validator: the sample breaks no rule; one planted defect per rule is found, named and located. */
#define _XOPEN_SOURCE 700
#include "damage.h"
#include "sample.h"

static char found[64][64]; /* "CGX-030 /cells/soma[1,2]" */
static int founds;

static void take(void *user, const conceg_problem *problem) {
  (void)user;
  CHECK(problem->size == sizeof *problem && *problem->expected && *problem->got);
  if (founds < 64) snprintf(found[founds++], sizeof found[0], "%s %s", problem->rule, problem->path);
}

/* Exactly this problem (and no other) is found; `only` limits the look to a group. */
static void expect_in(conceg_ctx *ctx, conceg_doc *doc, const char *only, const char *problem, int is_must) {
  founds = 0;
  const conceg_status status = conceg_doc_validate(doc, only, take, NULL);
  CHECK_EQUAL(status, is_must ? CONCEG_E_FORMAT : CONCEG_OK);
  int seen = 0;
  for (int i = 0; i < founds; i++)
    seen |= strcmp(found[i], problem) == 0;
  if (!seen || founds != 1) {
    fprintf(stderr, "expected only \"%s\", found:\n", problem);
    for (int i = 0; i < founds; i++)
      fprintf(stderr, "  %s\n", found[i]);
  }
  CHECK(seen && founds == 1);
  if (is_must) CHECK(strncmp(conceg_ctx_error(ctx), problem, 7) == 0);
}

#define PLANT(problem, must, damage)                                                                         \
  do {                                                                                                       \
    conceg_doc *doc = sample_doc(ctx);                                                                       \
    damage;                                                                                                  \
    expect_in(ctx, doc, NULL, problem, must);                                                                \
    conceg_doc_close(doc);                                                                                   \
  } while (0)
#define DROP(path) CHECK_EQUAL(conceg_doc_drop(doc, path), CONCEG_OK)

static void test_forms(conceg_ctx *ctx) {
  const float angle[3] = {0, 1, 0};
  PLANT("CGX-010 /cells/soma", 1, DROP("/cells/soma@unit"));
  PLANT("CGX-011 /cells/soma", 1,
        CHECK_EQUAL(conceg_doc_write_text(doc, "/cells/soma@unit", "mm"), CONCEG_OK));
  PLANT("CGX-012 /other", 0, CHECK_EQUAL(conceg_doc_write_text(doc, "/other/name", "x"), CONCEG_OK));
  PLANT("CGX-013 /cells/colour", 0, CHECK_EQUAL(conceg_doc_write_text(doc, "/cells/colour", "x"), CONCEG_OK));
  PLANT("CGX-020 /cells/radius", 1, DROP("/cells/radius"));
  PLANT("CGX-020 /domain@pia", 1, DROP("/domain@pia"));
  PLANT("CGX-021 /bars/angle", 1, sample_put(doc, ctx, "/bars/angle", CONCEG_F32, 3, 0, angle));
  PLANT("CGX-022 /bars/angle", 1, PUT("/bars/angle", CONCEG_F64, double, 1, 0, 1, 0));
  PLANT("CGX-022 /cells/rotation", 1,
        PUT("/cells/rotation", CONCEG_F64, double, 3, 1, 0, 0, 0, 1, 0, 0, 0, 1));
  PLANT("CGX-023 /meshes/compartment", 1, PUT("/meshes/compartment", CONCEG_U8, uint8_t, 0, 1, 1, 1));
  PLANT("CGX-024 /skeleton/kind", 1, PUT("/skeleton/kind", CONCEG_U8, uint8_t, 0, 3, 3, 3));
  PLANT("CGX-025 /cells/soma/", 1, {
    DROP("/cells/soma");
    CHECK_EQUAL(conceg_doc_write_text(doc, "/cells/soma/deep", "x"), CONCEG_OK);
  });
  PLANT("CGX-025 /cells", 1, {
    DROP("/cells");
    DROP("/bars");
    DROP("/skeleton");
    DROP("/spheres");
    DROP("/meshes");
    CHECK_EQUAL(conceg_doc_write_text(doc, "/cells", "x"), CONCEG_OK);
  });
  PLANT("CGX-065 /statistics/cells/icvf", 1, PUT("/statistics/cells/icvf", CONCEG_F64, double, 0, 0.4));
}

static void test_values(conceg_ctx *ctx) {
  PLANT("CGX-030 /cells/soma[1,2]", 1,
        PUT("/cells/soma", CONCEG_F64, double, 3, 1, 2, 3, 10, 20, NAN, 39, 0, 5));
  PLANT("CGX-030 /domain@hi[1]", 1, PUT("/domain@hi", CONCEG_F64, double, 0, 40, INFINITY, 40));
  PLANT("CGX-031 /skeleton/radius[2]", 1, PUT("/skeleton/radius", CONCEG_F32, float, 0, 1, 1, 0, 1));
  PLANT("CGX-031 /skeleton/radius[1]", 1, PUT("/skeleton/radius", CONCEG_F32, float, 0, 1, INFINITY, 1, NAN));
  PLANT("CGX-032 /cells/radius[0]", 1, PUT("/cells/radius", CONCEG_F32, float, 0, -1, 4, 0));
  PLANT("CGX-033 /cells/rotation[1,0]", 1,
        PUT("/cells/rotation", CONCEG_F64, double, 4, 1, 0, 0, 0, 0.6, 0.80001, 0, 0, 0, 0, 0, 1));
  PLANT("CGX-033 /domain@pia[0]", 1, PUT("/domain@pia", CONCEG_F64, double, 0, 0, 0, 2));
  PLANT("CGX-034 /cells/type[2]", 1, PUT("/cells/type", CONCEG_U32, uint32_t, 0, 0, 1, 2));
  PLANT("CGX-034 /meshes/cell[1]", 1, PUT("/meshes/cell", CONCEG_U32, uint32_t, 0, 0, 3));
  PLANT("CGX-036 /bars/state[1]", 1, PUT("/bars/state", CONCEG_U8, uint8_t, 0, 1, 9, 2));
  PLANT("CGX-036 /types/class[1]", 1,
        PUT("/types/class", CONCEG_TEXT, char *, 0, (char *)"pyramidal", (char *)"star"));
  PLANT("CGX-037 /cells/id[2]", 1, PUT("/cells/id", CONCEG_U64, uint64_t, 0, 11, 12, 11));
  PLANT("CGX-037 /types/name[1]", 1, PUT("/types/name", CONCEG_TEXT, char *, 0, (char *)"a", (char *)"a"));
  PLANT("CGX-062 /domain@hi[2]", 1, {
    PUT("/domain@hi", CONCEG_F64, double, 0, 40, 40, 0);
    DROP("/cells");
    DROP("/bars");
    DROP("/skeleton");
    DROP("/spheres");
    DROP("/meshes");
  });
  PLANT("CGX-063 /domain@periodic[1]", 1, PUT("/domain@periodic", CONCEG_U8, uint8_t, 0, 1, 2, 1));
  PLANT("CGX-064 /cells/soma[2,0]", 0,
        PUT("/cells/soma", CONCEG_F64, double, 3, 1, 2, 3, 10, 20, 30, 40, 0, 5));
}

static void test_links(conceg_ctx *ctx) {
  PLANT("CGX-040 /bars/cell_offset[0]", 1, PUT("/bars/cell_offset", CONCEG_U64, uint64_t, 0, 1, 2, 3, 3));
  PLANT("CGX-041 /bars/cell_offset[2]", 1, PUT("/bars/cell_offset", CONCEG_U64, uint64_t, 0, 0, 3, 2, 3));
  PLANT("CGX-042 /spheres/cell_offset[3]", 1,
        PUT("/spheres/cell_offset", CONCEG_U64, uint64_t, 0, 0, 1, 1, 2));
  PLANT("CGX-050 /skeleton/parent[1]", 1, PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 1, 1, -1));
  PLANT("CGX-050 /skeleton/parent[3]", 1,
        PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 0, 1, 0)); /* of another cell */
  PLANT("CGX-050 /bars/parent[0]", 1, PUT("/bars/parent", CONCEG_I64, int64_t, 0, -2, 0, -1));
  PLANT("CGX-051 /bars/handed_to[1]", 1, PUT("/bars/handed_to", CONCEG_I64, int64_t, 0, -1, 1, -1));
  PLANT("CGX-051 /dictionary/bar_parent[1]", 1, PUT("/dictionary/bar_parent", CONCEG_I64, int64_t, 0, -1, 2));
  PLANT("CGX-052 /skeleton/bar[3]", 1, PUT("/skeleton/bar", CONCEG_U32, uint32_t, 0, 0, 0, 1, 1));
  PLANT("CGX-052 /spheres/segment_end[0]", 1, PUT("/spheres/segment_end", CONCEG_I64, int64_t, 0, 3));
  PLANT("CGX-060 /meshes/face[6,1]", 1,
        PUT("/meshes/face", CONCEG_U32, uint32_t, 3, 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 2, 1, 0, 1, 3, 0,
            4, 2, 1, 2, 3));
  PLANT("CGX-061 /meshes/vertex[5,0]", 1,
        PUT("/meshes/vertex", CONCEG_F64, double, 3, 1, 2, 3, 2, 2, 3, 1, 3, 3, 1, 2, 4, 10, 20, 30, 11.1, 20,
            30, 10, 21, 30, 10, 20, 31));
}

static void test_origin(conceg_ctx *ctx) {
  char hex[65], line[80];
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_digest(doc, "/cells", hex), CONCEG_OK);
  snprintf(line, sizeof line, "cells=%s", hex);
  PUT("/bars@made_from", CONCEG_TEXT, char *, 0, line,
      (char *)"network=0000000000000000000000000000000000000000000000000000000000000000");
  founds = 0;
  CHECK_EQUAL(conceg_doc_validate(doc, NULL, take, NULL), CONCEG_OK);
  CHECK_EQUAL(founds, 0); /* /network was dropped since */
  PUT("/cells/radius", CONCEG_F32, float, 0, 5, 4.5f, 0);
  expect_in(ctx, doc, NULL, "CGX-070 /bars@made_from[0]", 0);
  founds = 0;
  CHECK_EQUAL(conceg_doc_validate(doc, "/cells", take, NULL), CONCEG_OK);
  CHECK_EQUAL(founds, 0);
  PUT("/bars@made_from", CONCEG_TEXT, char *, 0, (char *)"cells");
  expect_in(ctx, doc, "/bars", "CGX-071 /bars@made_from[0]", 1);
  conceg_doc_close(doc);
}

/* Defects that only another program can write, and files read array by array. */
static void test_files(conceg_ctx *ctx) {
  char path[256];
  const hsize_t two = 2;
  const uint8_t yes[2] = {1, 0};
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_save(doc, sample_path(path, "sample.cgx")), CONCEG_OK);
  conceg_doc_close(doc);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &doc), CONCEG_OK);
  founds = 0;
  CHECK_EQUAL(conceg_doc_validate(doc, NULL, take, NULL), CONCEG_OK);
  CHECK_EQUAL(founds, 0);
  conceg_doc_close(doc);
  hid_t file = damage_open(path);
  damage_text_attribute(file, "/", "length_unit", "mm");
  damage_close(file);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &doc), CONCEG_OK);
  expect_in(ctx, doc, NULL, "CGX-036 /@length_unit", 1);
  conceg_doc_close(doc);
  file = damage_open(path);
  damage_text_attribute(file, "/", "length_unit", "um");
  hid_t type = H5Tenum_create(H5T_NATIVE_UINT8);
  CHECK(H5Tenum_insert(type, "FALSE", &yes[1]) >= 0 && H5Tenum_insert(type, "TRUE", &yes[0]) >= 0);
  damage_dataset(file, "/cells/flag", type, 1, &two, H5P_DEFAULT, yes);
  damage_close(file);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &doc), CONCEG_OK);
  expect_in(ctx, doc, NULL, "CGX-008 /cells/flag", 1);
  conceg_doc_close(doc);
  H5Tclose(type);
  file = damage_open(path);
  CHECK(H5Ldelete(file, "/cells/flag", H5P_DEFAULT) >= 0 &&
        H5Ldelete(file, "/types/class", H5P_DEFAULT) >= 0);
  type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, 9);
  damage_dataset(file, "/types/class", type, 1, &two, H5P_DEFAULT, "pyramidalastro\xff\xff\xff\xff");
  damage_text_attribute(file, "/types/class", "unit", "");
  H5Tclose(type);
  damage_close(file);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &doc), CONCEG_OK);
  founds = 0;
  CHECK_EQUAL(conceg_doc_validate(doc, NULL, take, NULL), CONCEG_E_FORMAT);
  CHECK(founds == 2 && strcmp(found[0], "CGX-038 /types/class[1]") == 0);
  conceg_doc_close(doc);
  file = damage_open(path);
  CHECK(H5Ldelete(file, "/types/class", H5P_DEFAULT) >= 0);
  const double value = 1;
  damage_dataset(file, "/statistics/cells x/mean", H5T_NATIVE_DOUBLE, 0, NULL, H5P_DEFAULT, &value);
  damage_text_attribute(file, "/statistics/cells x/mean", "unit", "1");
  damage_close(file);
  CHECK_EQUAL(conceg_doc_open(ctx, path, &doc), CONCEG_OK);
  expect_in(ctx, doc, "/statistics", "CGX-007 /statistics/cells x/", 1);
  conceg_doc_close(doc);
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  sample_folder();
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_validate(doc, "/nothing", NULL, NULL), CONCEG_E_MISSING);
  CHECK_EQUAL(conceg_doc_validate(doc, "/cells/", NULL, NULL), CONCEG_OK);
  conceg_doc_close(doc);
  test_forms(ctx);
  test_values(ctx);
  test_links(ctx);
  test_origin(ctx);
  test_files(ctx);
  conceg_ctx_free(ctx);
  sample_clean();
  return check_done();
}
