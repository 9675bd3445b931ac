/* SPDX-License-Identifier: BSD-3-Clause
 * Files of fibre bundles as fastpli's .h5 are: groups 0, 1, ... of bundles with datasets 0, 1, ... of rows
 * x y z r. */
#ifndef CONCEG_TESTS_BUNDLES_SAMPLE_H
#define CONCEG_TESTS_BUNDLES_SAMPLE_H

#include "check.h"

#include <hdf5.h>
#include <stdio.h>

/* Two bundles of two fibres and one; `packed` = the newest form of HDF5, chunks, compressed, floats of the
 * other byte order, and attributes as fastpli has them; otherwise its oldest form. */
static inline void bundles_save(const char *path, int packed) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (packed) H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
  const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
  CHECK(file >= 0);
  for (int bundle = 0; bundle < 2; bundle++) {
    const char name[2] = {(char)('0' + bundle), 0};
    const hid_t group = H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    for (int fibre = 0; fibre < 2 - bundle; fibre++) {
      const hsize_t shape[2] = {(hsize_t)(3 + fibre), 4}, chunk[2] = {2, 4};
      double row[4][4];
      for (int i = 0; i < 4; i++)
        row[i][0] = 3 + i, row[i][1] = 4 + bundle, row[i][2] = 6 + fibre, row[i][3] = 0.5;
      const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
      if (packed) H5Pset_chunk(list, 2, chunk), H5Pset_shuffle(list), H5Pset_deflate(list, 6);
      const char data_name[2] = {(char)('0' + fibre), 0};
      const hid_t space = H5Screate_simple(2, shape, NULL);
      const hid_t data = H5Dcreate2(group, data_name, packed ? H5T_IEEE_F32BE : H5T_IEEE_F64LE, space,
                                    H5P_DEFAULT, list, H5P_DEFAULT);
      CHECK(data >= 0 && H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, row) >= 0);
      H5Dclose(data), H5Sclose(space), H5Pclose(list);
    }
    H5Gclose(group);
  }
  CHECK(H5Fclose(file) >= 0);
  H5Pclose(access);
}

#endif
