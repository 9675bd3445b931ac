/* SPDX-License-Identifier: BSD-3-Clause
 * A document with one array of so many MiB that takes no room on the disk.  sparse FILE.cgx MIB */
#include <hdf5.h>

#include <stdlib.h>

static void attribute(hid_t owner, const char *name, hid_t type, hsize_t count, const void *value) {
  const hid_t space = count ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR);
  const hid_t made = H5Acreate2(owner, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(made, type, value);
  H5Aclose(made);
  H5Sclose(space);
}

static hid_t text_type(size_t width) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, width);
  return type;
}

int main(int argc, char **argv) {
  static const unsigned version[2] = {1, 0};
  static const unsigned char complete = 1;
  if (argc != 3) return 2;
  const hsize_t count = (hsize_t)strtoul(argv[2], NULL, 10) << 17; /* doubles */
  const hid_t file = count ? H5Fcreate(argv[1], H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT) : -1;
  if (file < 0) return 2;
  attribute(file, "format", text_type(18), 0, "conceg-interchange");
  attribute(file, "version", H5T_NATIVE_UINT, 2, version);
  attribute(file, "length_unit", text_type(2), 0, "um");
  attribute(file, "time_unit", text_type(2), 0, "ms");
  attribute(file, "complete", H5T_NATIVE_UCHAR, 0, &complete);
  const hid_t group = H5Gcreate2(file, "x_big", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t list = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(1, &count, NULL);
  H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(list, H5D_FILL_TIME_NEVER);
  const hid_t array = H5Dcreate2(group, "array", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
  attribute(array, "unit", text_type(2), 0, "um");
  const hid_t small = H5Gcreate2(file, "x_small", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(small);
  H5Dclose(array);
  H5Gclose(group);
  return H5Fclose(file) < 0;
}
