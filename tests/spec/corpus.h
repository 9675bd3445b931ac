/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the makers of spec/conformance: a tiny tissue in parts, and how a file gets its manifest row. */
#ifndef CONCEG_TESTS_CORPUS_H
#define CONCEG_TESTS_CORPUS_H

#include "../unit/damage.h"
#include "../unit/sample.h"

enum part {
  BOX = 1,
  TYPES = 2,
  DICTIONARY = 4,
  BARS = 8,
  NETWORK = 16,
  SKELETON = 32,
  SPHERES = 64,
  MESHES = 128,
  VOLUMES = 256,
  TABLES = 512,
  PROVENANCE = 1024,
  RECIPE = 2048
};

struct maker {
  conceg_ctx *ctx;
  const char *folder; /* of the corpus */
  FILE *manifest;
  char path[1024];
};

/* A document with these parts of the tissue, which keeps every rule. */
conceg_doc *corpus_doc(conceg_ctx *ctx, unsigned parts);

/* Starts a file: its row goes to the manifest, its full path is returned (borrowed until the next one). */
const char *corpus_file(struct maker *maker, const char *name, const char *expect, const char *rule, int code,
                        const char *note);
/* Saves and closes. */
void corpus_save(struct maker *maker, conceg_doc *doc, const char *path);
/* A list for datasets without times, so that a file is the same whenever it is made. */
hid_t corpus_list(void);
/* A dataset with @unit, made by HDF5 itself. */
void corpus_dataset(hid_t file, const char *path, hid_t type, int rank, const hsize_t *shape, hid_t list,
                    const void *value, const char *unit);
/* Takes an object of a file away and leaves its place empty. */
void corpus_delete(hid_t file, const char *path);

void make_passed(struct maker *maker);
void make_failed(struct maker *maker);
void make_stream(struct maker *maker);
void make_roundtrip(struct maker *maker);

#endif
