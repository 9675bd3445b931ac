/* SPDX-License-Identifier: BSD-3-Clause
 * A small document that keeps every rule of spec/cgx.md, for tests to save, to read and to damage. */
#ifndef CONCEG_TESTS_SAMPLE_H
#define CONCEG_TESTS_SAMPLE_H

#include "check.h"

#include "conceg/doc.h"

#include <unistd.h>

static inline conceg_ctx *sample_ctx(void) {
  conceg_ctx *ctx = conceg_ctx_new();
  CHECK(ctx != NULL);
  if (!ctx) exit(1);
  return ctx;
}

/* Writes numbers; rank 2 when columns > 0. Ends the test when it fails. */
static inline void sample_put(conceg_doc *doc, conceg_ctx *ctx, const char *path, conceg_dtype dtype,
                              uint64_t rows, uint64_t columns, const void *data) {
  conceg_array array = {.size = sizeof array,
                        .dtype = dtype,
                        .rank = columns ? 2u : 1u,
                        .shape = {rows, columns},
                        .data = data};
  if (conceg_doc_write(doc, path, &array) == CONCEG_OK) return;
  fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  exit(1);
}
static inline void sample_scalar(conceg_doc *doc, conceg_ctx *ctx, const char *path, conceg_dtype dtype,
                                 const void *data) {
  conceg_array array = {.size = sizeof array, .dtype = dtype, .data = data};
  if (conceg_doc_write(doc, path, &array) == CONCEG_OK) return;
  fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  exit(1);
}

#define PUT(path, dtype, type, columns, ...)                                                                 \
  do {                                                                                                       \
    const type values_[] = {__VA_ARGS__};                                                                    \
    const uint64_t count_ = sizeof values_ / sizeof *values_;                                                \
    sample_put(doc, ctx, path, dtype, (columns) ? count_ / ((columns) ? (columns) : 1) : count_, columns,    \
               values_);                                                                                     \
  } while (0)

static inline void sample_domain(conceg_doc *doc, conceg_ctx *ctx) {
  const double step = 1.0 / 65536;
  PUT("/domain@lo", CONCEG_F64, double, 0, 0, 0, 0);
  PUT("/domain@hi", CONCEG_F64, double, 0, 40, 40, 40);
  PUT("/domain@periodic", CONCEG_U8, uint8_t, 0, 1, 1, 1);
  PUT("/domain@pia", CONCEG_F64, double, 0, 0, 0, 1);
  sample_scalar(doc, ctx, "/domain@lattice_step", CONCEG_F64, &step);
}

static inline void sample_cells(conceg_doc *doc, conceg_ctx *ctx) {
  PUT("/types/name", CONCEG_TEXT, char *, 0, (char *)"L4 pyramidal", (char *)"astrocyte");
  PUT("/types/class", CONCEG_TEXT, char *, 0, (char *)"pyramidal", (char *)"astrocyte");
  PUT("/types/fraction", CONCEG_F64, double, 0, 0.62, 0.38);
  PUT("/cells/id", CONCEG_U64, uint64_t, 0, 11, 12, 13);
  PUT("/cells/type", CONCEG_U32, uint32_t, 0, 0, 1, 0);
  PUT("/cells/rotation", CONCEG_F64, double, 4, 1, 0, 0, 0, 0.6, 0.8, 0, 0, 0, 0, 0, 1);
  PUT("/cells/soma", CONCEG_F64, double, 3, 1, 2, 3, 10, 20, 30, 39.5, 0, 5);
  PUT("/cells/radius", CONCEG_F32, float, 0, 5, 4, 0);
}

static inline void sample_bars(conceg_doc *doc, conceg_ctx *ctx) {
  PUT("/bars/cell_offset", CONCEG_U64, uint64_t, 0, 0, 2, 3, 3);
  PUT("/bars/tree", CONCEG_U32, uint32_t, 0, 0, 0, 0);
  PUT("/bars/parent", CONCEG_I64, int64_t, 0, -1, 0, -1);
  PUT("/bars/neurite", CONCEG_U8, uint8_t, 0, 3, 3, 7);
  PUT("/bars/asked_start", CONCEG_F64, double, 0, 0, 10, 0);
  PUT("/bars/asked_end", CONCEG_F64, double, 0, 50, 40, 20);
  PUT("/bars/attractor", CONCEG_F64, double, 3, 1, 2, 60, 30, 2, 3, 10, 20, -5);
  PUT("/bars/angle", CONCEG_F64, double, 0, 0, 1, 0);
  PUT("/bars/radius", CONCEG_F64, double, 0, 0.5, 0.4, 0.2);
  PUT("/bars/taper", CONCEG_F64, double, 0, -0.001, 0, 0);
  PUT("/bars/radius_floor", CONCEG_F64, double, 0, 0.1, 0.1, 0.1);
  PUT("/bars/state", CONCEG_U8, uint8_t, 0, 1, 4, 2);
  PUT("/bars/handed_to", CONCEG_I64, int64_t, 0, -1, 0, -1);
}

static inline void sample_skeleton(conceg_doc *doc, conceg_ctx *ctx) {
  PUT("/skeleton/cell_offset", CONCEG_U64, uint64_t, 0, 0, 3, 4, 4);
  PUT("/skeleton/position", CONCEG_F64, double, 3, 1, 2, 8, 1, 2, 10, 2, 2, 12, 10, 20, 26);
  PUT("/skeleton/radius", CONCEG_F32, float, 0, 0.5f, 0.5f, 0.4f, 0.2f);
  PUT("/skeleton/target_radius", CONCEG_F32, float, 0, 0.5f, 0.5f, 0.4f, 0.2f);
  PUT("/skeleton/parent", CONCEG_I64, int64_t, 0, -1, 0, 1, -1);
  PUT("/skeleton/kind", CONCEG_U8, uint8_t, 0, 3, 3, 3, 7);
  PUT("/skeleton/bar", CONCEG_U32, uint32_t, 0, 0, 0, 1, 0);
  PUT("/spheres/cell_offset", CONCEG_U64, uint64_t, 0, 0, 1, 1, 1);
  PUT("/spheres/center", CONCEG_F64, double, 3, 1, 2, 9);
  PUT("/spheres/radius", CONCEG_F32, float, 0, 0.5f);
  PUT("/spheres/segment_end", CONCEG_I64, int64_t, 0, 1);
}

/* Two tetrahedra: of cell 0 around (1, 2, 3) and of cell 1 around (10, 20, 30). */
static inline void sample_meshes(conceg_doc *doc, conceg_ctx *ctx) {
  PUT("/meshes/cell", CONCEG_U32, uint32_t, 0, 0, 1);
  PUT("/meshes/form", CONCEG_TEXT, char *, 0, (char *)"closed", (char *)"closed");
  PUT("/meshes/origin", CONCEG_F64, double, 3, 1, 2, 3, 10, 20, 30);
  PUT("/meshes/vertex_offset", CONCEG_U64, uint64_t, 0, 0, 4, 8);
  PUT("/meshes/face_offset", CONCEG_U64, uint64_t, 0, 0, 4, 8);
  PUT("/meshes/vertex", CONCEG_F64, double, 3, 1, 2, 3, 2, 2, 3, 1, 3, 3, 1, 2, 4, 10, 20, 30, 11, 20, 30, 10,
      21, 30, 10, 20, 31);
  PUT("/meshes/face", CONCEG_U32, uint32_t, 3, 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 2, 1, 0, 1, 3, 0, 3, 2,
      1, 2, 3);
  PUT("/meshes/compartment", CONCEG_U8, uint8_t, 0, 1, 1, 1, 3, 1, 1, 1, 7);
  PUT("/meshes/volume", CONCEG_F64, double, 0, 1.0 / 6, 1.0 / 6);
  PUT("/meshes/area", CONCEG_F64, double, 0, 2.3660254037844386, 2.3660254037844386);
}

static inline void sample_dictionary(conceg_doc *doc, conceg_ctx *ctx) {
  PUT("/dictionary/entry_name", CONCEG_TEXT, char *, 0, (char *)"L4_pyramidal");
  PUT("/dictionary/entry_class", CONCEG_TEXT, char *, 0, (char *)"pyramidal");
  PUT("/dictionary/entry_donor_offset", CONCEG_U64, uint64_t, 0, 0, 1);
  PUT("/dictionary/entry_angle_offset", CONCEG_U64, uint64_t, 0, 0, 1);
  PUT("/dictionary/angle", CONCEG_F64, double, 0, 1.1);
  PUT("/dictionary/donor_id", CONCEG_TEXT, char *, 0, (char *)"donor-1");
  PUT("/dictionary/donor_soma_radius", CONCEG_F64, double, 0, 5);
  PUT("/dictionary/donor_tree_offset", CONCEG_U64, uint64_t, 0, 0, 1);
  PUT("/dictionary/tree_neurite", CONCEG_U8, uint8_t, 0, 3);
  PUT("/dictionary/tree_trunk_direction", CONCEG_F64, double, 3, 0, 0, 1);
  PUT("/dictionary/tree_bar_offset", CONCEG_U64, uint64_t, 0, 0, 2);
  PUT("/dictionary/bar_birth", CONCEG_F64, double, 0, 0, 10);
  PUT("/dictionary/bar_death", CONCEG_F64, double, 0, 100, 60);
  PUT("/dictionary/bar_parent", CONCEG_I64, int64_t, 0, -1, 0);
  PUT("/dictionary/bar_radius", CONCEG_F64, double, 0, 0.5, 0.3);
  PUT("/dictionary/bar_taper", CONCEG_F64, double, 0, -0.001, 0);
  PUT("/dictionary/bar_angle", CONCEG_F64, double, 0, 0, 1.1);
  PUT("/dictionary/bar_tip_direction", CONCEG_F64, double, 3, 0, 0, 1, 0.6, 0.8, 0);
  PUT("/dictionary/bar_tip_distance", CONCEG_F64, double, 0, 90, 55);
}

/* A new document with everything above, a table and a foreign group. */
static inline conceg_doc *sample_doc(conceg_ctx *ctx) {
  conceg_doc *doc = NULL;
  if (conceg_doc_new(ctx, &doc) != CONCEG_OK) {
    fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    exit(1);
  }
  sample_meshes(doc, ctx); /* in an order that is not the canonical one */
  sample_skeleton(doc, ctx);
  sample_bars(doc, ctx);
  sample_cells(doc, ctx);
  sample_dictionary(doc, ctx);
  sample_domain(doc, ctx);
  PUT("/statistics/cells/icvf", CONCEG_F64, double, 0, 0.4, 0.5);
  PUT("/statistics/cells/count", CONCEG_U64, uint64_t, 0, 2, 3);
  PUT("/x_lab/deep/notes", CONCEG_TEXT, char *, 0, (char *)"caf\xc3\xa9", (char *)"", (char *)"a longer one");
  CHECK_EQUAL(conceg_doc_write_text(doc, "/recipe", "conceg: 1\nseed: 1\n"), CONCEG_OK);
  return doc;
}

/* A folder of this test alone, removed by sample_clean; borrowed. */
static inline const char *sample_folder(void) {
  static char folder[64];
  if (*folder) return folder;
  strcpy(folder, "conceg-test-XXXXXX");
  if (!mkdtemp(folder)) exit(1);
  return folder;
}
static inline const char *sample_path(char path[256], const char *name) {
  snprintf(path, 256, "%s/%s", sample_folder(), name);
  return path;
}
static inline void sample_clean(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", sample_folder());
  CHECK_EQUAL(system(command), 0);
}
/* Names in the test's folder, hidden ones too. */
static inline int sample_files(void) {
  char command[128];
  snprintf(command, sizeof command, "ls -A '%s' | wc -l", sample_folder());
  FILE *pipe = popen(command, "r");
  int count = -1;
  if (!pipe || fscanf(pipe, "%d", &count) != 1) count = -1;
  if (pipe) pclose(pipe);
  return count;
}

/* 1 when both files hold the same bytes. */
static inline int sample_same(const char *a, const char *b) {
  char command[600];
  snprintf(command, sizeof command, "cmp -s '%s' '%s'", a, b);
  return system(command) == 0;
}

#endif
