/* SPDX-License-Identifier: BSD-3-Clause
 * Seeds of the document target: small documents, each a step richer, in the canonical form and in the oldest
 * form of HDF5, whose metadata has no checksums, so that damage gets past the door; and of the bundles target.
 * make_seeds FOLDER FOLDER-OF-BUNDLES */
#include "../unit/sample.h"
#include "bundles_sample.h"

#include <hdf5.h>

static herr_t copy_attribute(hid_t from, const char *name, const H5A_info_t *info, void *user) {
  const hid_t to = *(const hid_t *)user, source = H5Aopen(from, name, H5P_DEFAULT),
              type = H5Aget_type(source), space = H5Aget_space(source),
              target = H5Acreate2(to, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  char bytes[4096];
  (void)info;
  CHECK(H5Aget_storage_size(source) < sizeof bytes && H5Aread(source, type, bytes) >= 0 &&
        H5Awrite(target, type, bytes) >= 0);
  H5Aclose(target), H5Aclose(source), H5Tclose(type), H5Sclose(space);
  return 0;
}

static herr_t copy_object(hid_t from, const char *name, const H5L_info_t *info, void *user) {
  (void)info;
  return H5Ocopy(from, name, *(const hid_t *)user, name, H5P_DEFAULT, H5P_DEFAULT);
}

/* The same content with a superblock of version 0, old groups, and one compressed array. */
static void save_old(const char *path, const char *old) {
  const hid_t from = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT),
              to = H5Fcreate(old, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t count = 64, chunk = 16;
  hsize_t at = 0;
  float values[64] = {1, 2, 3};
  CHECK(from >= 0 && to >= 0);
  CHECK(H5Aiterate2(from, H5_INDEX_NAME, H5_ITER_NATIVE, &at, copy_attribute, (void *)(uintptr_t)&to) >= 0);
  at = 0;
  CHECK(H5Literate(from, H5_INDEX_NAME, H5_ITER_NATIVE, &at, copy_object, (void *)(uintptr_t)&to) >= 0);
  const hid_t list = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(1, &count, NULL);
  H5Pset_chunk(list, 1, &chunk);
  H5Pset_shuffle(list);
  H5Pset_deflate(list, 6);
  const hid_t array = H5Dcreate2(to, "x_packed", H5T_IEEE_F32LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
  CHECK(H5Dwrite(array, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Dclose(array), H5Pclose(list), H5Sclose(space), H5Fclose(to), H5Fclose(from);
}

static void save(conceg_doc *doc, const char *folder, const char *name) {
  char path[512], old[512];
  snprintf(path, sizeof path, "%s/%s.cgx", folder, name);
  snprintf(old, sizeof old, "%s/%s-old.cgx", folder, name);
  CHECK_EQUAL(conceg_doc_save(doc, path), CONCEG_OK);
  save_old(path, old);
}

int main(int argc, char **argv) {
  conceg_ctx *ctx = sample_ctx();
  conceg_doc *doc = NULL;
  char path[512];
  if (argc != 3) return 2;
  for (int packed = 0; packed < 2; packed++) {
    snprintf(path, sizeof path, "%s/%s.h5", argv[2], packed ? "packed" : "old");
    bundles_save(path, packed);
  }
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  save(doc, argv[1], "empty");
  sample_domain(doc, ctx);
  save(doc, argv[1], "domain");
  sample_cells(doc, ctx);
  save(doc, argv[1], "cells");
  sample_skeleton(doc, ctx);
  save(doc, argv[1], "skeleton");
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  doc = sample_doc(ctx);
  save(doc, argv[1], "all");
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return check_done();
}
