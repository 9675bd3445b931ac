/* SPDX-License-Identifier: BSD-3-Clause
 * Changes a saved document behind the library's back, with HDF5 itself. */
#ifndef CONCEG_TESTS_DAMAGE_H
#define CONCEG_TESTS_DAMAGE_H

#include "check.h"

#include <hdf5.h>

static inline hid_t damage_open(const char *path) {
  const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  CHECK(file >= 0);
  return file;
}

static inline void damage_close(hid_t file) {
  CHECK(H5Fclose(file) >= 0);
}

/* A new attribute, or another in its place; `count` 0 = a scalar. */
static inline void damage_attribute(hid_t file, const char *object, const char *name, hid_t type,
                                    hsize_t count, const void *value) {
  if (H5Aexists_by_name(file, object, name, H5P_DEFAULT) > 0)
    H5Adelete_by_name(file, object, name, H5P_DEFAULT);
  const hid_t space = count ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR);
  const hid_t attribute =
      H5Acreate_by_name(file, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  CHECK(attribute >= 0 && H5Awrite(attribute, type, value) >= 0);
  H5Aclose(attribute);
  H5Sclose(space);
}

static inline void damage_text_attribute(hid_t file, const char *object, const char *name, const char *text) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, strlen(text) + 1);
  damage_attribute(file, object, name, type, 0, text);
  H5Tclose(type);
}

/* A new dataset with the given creation list; `value` NULL = nothing is written. */
static inline void damage_dataset(hid_t file, const char *path, hid_t type, int rank, const hsize_t *shape,
                                  hid_t list, const void *value) {
  const hid_t space = rank ? H5Screate_simple(rank, shape, NULL) : H5Screate(H5S_SCALAR);
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t dataset = H5Dcreate2(file, path, type, space, links, list, H5P_DEFAULT);
  CHECK(dataset >= 0 && (!value || H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0));
  H5Dclose(dataset);
  H5Pclose(links);
  H5Sclose(space);
}

#endif
