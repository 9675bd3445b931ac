// SPDX-License-Identifier: BSD-3-Clause
// The only file of the stage that knows HDF5.
#include "h5_morphology.hpp"

#include "guard.hpp"

#include <hdf5.h>

namespace conceg::exporting {
namespace {

class Id {
public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) fail(CONCEG_E_IO, "h5v1: HDF5 could not encode the data");
  }
  ~Id() { close_(id_); }
  Id(const Id &) = delete;
  Id &operator=(const Id &) = delete;
  operator hid_t() const { return id_; }

private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void put(hid_t file, const char *name, hid_t stored, hid_t held, hsize_t rows, hsize_t columns,
         const void *values) {
  const hsize_t shape[2] = {rows, columns};
  const Id space(H5Screate_simple(2, shape, nullptr), H5Sclose);
  const Id create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(create, 0); // same content, same bytes
  const Id data(H5Dcreate2(file, name, stored, space, H5P_DEFAULT, create, H5P_DEFAULT), H5Dclose);
  if (H5Dwrite(data, held, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    fail(CONCEG_E_IO, "h5v1: HDF5 could not encode the data");
}

} // namespace

std::string h5v1_bytes(const H5Morphology &morphology) {
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access, 1 << 16, 0); // in memory; the file appears whole
  const Id file(H5Fcreate("conceg-morphology.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  put(file, "points", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, morphology.points.size() / 4, 4,
      morphology.points.data());
  put(file, "structure", H5T_STD_I32LE, H5T_NATIVE_INT32, morphology.structure.size() / 3, 3,
      morphology.structure.data());
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  std::string bytes(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
  if (size <= 0 || H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
    fail(CONCEG_E_IO, "h5v1: HDF5 could not encode the data");
  return bytes;
}

} // namespace conceg::exporting
