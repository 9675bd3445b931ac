/* SPDX-License-Identifier: BSD-3-Clause
 * Makes spec/conformance: test_corpus FOLDER writes every document and manifest.tsv below FOLDER. The bytes
 * depend on nothing but this program and the HDF5 library. */
#define _XOPEN_SOURCE 700
#include "corpus.h"

#include <errno.h>
#include <sys/stat.h>

static void put_volumes(conceg_doc *doc, conceg_ctx *ctx) {
  uint32_t label[512] = {0};
  for (uint32_t i = 0; i < 512; i++)
    label[i] = i < 256 ? 1 : 0;
  PUT("/volumes@origin", CONCEG_F64, double, 0, 0.5, 0.5, 0.5);
  PUT("/volumes@spacing", CONCEG_F64, double, 0, 1, 1, 1);
  PUT("/volumes@shape", CONCEG_U64, uint64_t, 0, 8, 8, 8);
  PUT("/volumes/leaf_origin", CONCEG_I32, int32_t, 3, 0, 0, 0);
  sample_put(doc, ctx, "/volumes/label", CONCEG_U32, 1, 512, label);
}

static void put_network(conceg_doc *doc, conceg_ctx *ctx) {
  PUT("/network/position", CONCEG_F64, double, 3, 1, 1, 1, 2, 2, 2, 39, 1, 1);
  PUT("/network/radius", CONCEG_F32, float, 0, 1, 0.5f, 1);
  PUT("/network/edge_offset", CONCEG_U64, uint64_t, 0, 0, 2, 3, 4);
  PUT("/network/edge", CONCEG_U32, uint32_t, 0, 1, 2, 0, 0);
  PUT("/network/edge_shift", CONCEG_I8, int8_t, 3, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0);
}

static void put_provenance(conceg_doc *doc, conceg_ctx *ctx) {
  PUT("/provenance/stage", CONCEG_TEXT, char *, 0, (char *)"place", (char *)"grow");
  PUT("/provenance/implementation", CONCEG_TEXT, char *, 0, (char *)"uniform", (char *)"attractor");
  PUT("/provenance/seed", CONCEG_U64, uint64_t, 0, 1, 1);
}

conceg_doc *corpus_doc(conceg_ctx *ctx, unsigned parts) {
  static const char *const spheres[] = {"/spheres"}, *const skeleton[] = {"/skeleton", "/spheres"};
  conceg_doc *doc = NULL;
  if (conceg_doc_new(ctx, &doc) != CONCEG_OK) exit(1);
  if (parts & RECIPE) CHECK_EQUAL(conceg_doc_write_text(doc, "/recipe", "conceg: 1\nseed: 1\n"), CONCEG_OK);
  if (parts & BOX) sample_domain(doc, ctx);
  if (parts & DICTIONARY) sample_dictionary(doc, ctx);
  if (parts & TYPES) sample_cells(doc, ctx);
  if (parts & BARS) sample_bars(doc, ctx);
  if (parts & NETWORK) put_network(doc, ctx);
  if (parts & (SKELETON | SPHERES)) sample_skeleton(doc, ctx);
  if (!(parts & SPHERES)) CHECK_EQUAL(conceg_doc_drop(doc, spheres[0]), CONCEG_OK);
  if (!(parts & SKELETON) && (parts & SPHERES)) CHECK_EQUAL(conceg_doc_drop(doc, skeleton[0]), CONCEG_OK);
  if (!(parts & BARS)) CHECK_EQUAL(conceg_doc_drop(doc, "/skeleton/bar"), CONCEG_OK);
  if (parts & MESHES) sample_meshes(doc, ctx);
  if (parts & VOLUMES) put_volumes(doc, ctx);
  if (parts & TABLES) {
    PUT("/statistics/cells/icvf", CONCEG_F64, double, 0, 0.4, 0.5);
    PUT("/statistics/cells/count", CONCEG_U64, uint64_t, 0, 2, 3);
  }
  if (parts & PROVENANCE) put_provenance(doc, ctx);
  return doc;
}

const char *corpus_file(struct maker *maker, const char *name, const char *expect, const char *rule, int code,
                        const char *note) {
  fprintf(maker->manifest, "%s\t%s\t%s\t%d\t%s\n", name, expect, rule, code, note);
  snprintf(maker->path, sizeof maker->path, "%s/%s", maker->folder, name);
  return maker->path;
}

void corpus_save(struct maker *maker, conceg_doc *doc, const char *path) {
  if (conceg_doc_save(doc, path) != CONCEG_OK) {
    fprintf(stderr, "%s\n", conceg_ctx_error(maker->ctx));
    CHECK(!"the document is saved");
  }
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
}

hid_t corpus_list(void) {
  const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(list, 0);
  return list;
}

void corpus_dataset(hid_t file, const char *path, hid_t type, int rank, const hsize_t *shape, hid_t list,
                    const void *value, const char *unit) {
  damage_dataset(file, path, type, rank, shape, list, value);
  if (unit) damage_text_attribute(file, path, "unit", unit);
}

void corpus_delete(hid_t file, const char *path) {
  CHECK(H5Ldelete(file, path, H5P_DEFAULT) >= 0);
}

static void put_program_rules(FILE *manifest) {
  static const char *const rows[][2] = {{"CGX-014", "spec.conformance"},
                                        {"CGX-015", "pipe.replace-stage"},
                                        {"CGX-067", "interop.meshes"},
                                        {"STR-002", "spec.conformance"},
                                        {"STR-003", "cli.cli"},
                                        {"STR-004", "cli.cli"},
                                        {"STR-005", "cli.cli"},
                                        {"STR-006", "spec.conformance"},
                                        {"STR-010", "spec.conformance"},
                                        {"STR-011", "pipe.replace-stage"},
                                        {"STR-012", "pipe.replace-stage"},
                                        {"STR-020", "cli.cli"},
                                        {"STR-021", "cli.cli"},
                                        {"STR-023", "cli.terminal"},
                                        {"STR-024", "cli.terminal"},
                                        {"STR-025", "cli.cli"},
                                        {"STR-026", "cli.cli"},
                                        {"STR-027", "unit.saving"},
                                        {"STR-028", "faults.kill"},
                                        {"STR-029", "cli.cli"}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    fprintf(manifest, "-\ttest\t%s\t-\t%s\n", rows[i][0], rows[i][1]);
}

int main(int argc, char **argv) {
  static const char *const folders[] = {"passed", "failed", "stream", "roundtrip"};
  char path[1024];
  if (argc != 2) {
    fprintf(stderr, "usage: test_corpus FOLDER\n");
    return 2;
  }
  struct maker maker = {.ctx = sample_ctx(), .folder = argv[1]};
  for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
    snprintf(path, sizeof path, "%s/%s", argv[1], folders[i]);
    CHECK(mkdir(path, 0777) == 0 || errno == EEXIST);
  }
  snprintf(path, sizeof path, "%s/manifest.tsv", argv[1]);
  maker.manifest = fopen(path, "w");
  if (!maker.manifest) {
    fprintf(stderr, "%s: cannot be made\n", path);
    return 1;
  }
  fputs("# SPDX-License-Identifier: BSD-3-Clause\n# file, verdict, rule, exit code, note: see README.md\n",
        maker.manifest);
  make_passed(&maker);
  make_failed(&maker);
  make_stream(&maker);
  make_roundtrip(&maker);
  put_program_rules(maker.manifest);
  CHECK(fclose(maker.manifest) == 0);
  conceg_ctx_free(maker.ctx);
  return check_done();
}
