// SPDX-License-Identifier: BSD-3-Clause
// The only file of the stage that knows HDF5.
#include "h5_bundles.hpp"

#include "guard.hpp"

#include <hdf5.h>

#include <algorithm>
#include <charconv>

namespace conceg::importing {
namespace {

class Id {
public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(const Id &) = delete;
  Id &operator=(const Id &) = delete;
  operator hid_t() const { return id_; }

private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// Names of a group's links, which must be whole numbers, in their order.
std::vector<std::string> numbered(hid_t group, const std::string &path, const std::string &where) {
  H5G_info_t info = {};
  if (H5Gget_info(group, &info) < 0)
    fail(CONCEG_E_FORMAT, "%s: %s: cannot be listed", path.c_str(), where.c_str());
  std::vector<std::pair<std::uint64_t, std::string>> names;
  for (hsize_t i = 0; i < info.nlinks; i++) {
    char name[32] = "";
    const ssize_t length =
        H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
    std::uint64_t number = 0;
    const char *end = name + (length > 0 && length < 20 ? length : 0);
    if (end == name || std::from_chars(name, end, number).ptr != end)
      fail(CONCEG_E_FORMAT, "%s: %s: expected names that are numbers, got \"%.20s\"", path.c_str(),
           where.c_str(), name);
    names.emplace_back(number, name);
  }
  std::sort(names.begin(), names.end());
  std::vector<std::string> sorted;
  for (auto &[number, name] : names)
    sorted.push_back(std::move(name));
  return sorted;
}

// What HDF5 takes memory for by the word of the file alone: an element while it is converted, a whole chunk.
void check_storage(hid_t data, hid_t file, const std::string &where) {
  const Id type(H5Dget_type(data), H5Tclose), list(H5Dget_create_plist(data), H5Pclose);
  const H5T_class_t kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
  const std::size_t size = type < 0 ? 0 : H5Tget_size(type);
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || size > 16)
    fail(CONCEG_E_FORMAT, "%s: expected numbers of at most 16 bytes", where.c_str());
  hsize_t chunk[2] = {0, 0}, length = 0;
  if (list < 0 || H5Fget_filesize(file, &length) < 0)
    fail(CONCEG_E_FORMAT, "%s: cannot be looked at", where.c_str());
  if (H5Pget_layout(list) == H5D_CHUNKED && H5Pget_chunk(list, 2, chunk) == 2 &&
      static_cast<double>(chunk[0]) * static_cast<double>(chunk[1]) * static_cast<double>(size) >
          256.0 * static_cast<double>(length) + 1048576.0)
    fail(CONCEG_E_FORMAT, "%s: expected chunks that fit a file of %llu bytes, got %llu x %llu values",
         where.c_str(), static_cast<unsigned long long>(length), static_cast<unsigned long long>(chunk[0]),
         static_cast<unsigned long long>(chunk[1]));
}

} // namespace

std::vector<BundleFibre> read_h5_bundles(const std::string &path, std::uint64_t memory) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file < 0)
    fail(CONCEG_E_FORMAT, "%s: expected an HDF5 file of fibre bundles, it cannot be opened as one",
         path.c_str());
  std::vector<BundleFibre> fibres;
  double bytes = 0.0;
  for (const std::string &bundle : numbered(file, path, "/")) {
    const Id group(H5Gopen2(file, bundle.c_str(), H5P_DEFAULT), H5Gclose);
    if (group < 0) fail(CONCEG_E_FORMAT, "%s: /%s: expected a group of fibres", path.c_str(), bundle.c_str());
    for (const std::string &name : numbered(group, path, "/" + bundle)) {
      const Id data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
      const Id space(data < 0 ? -1 : H5Dget_space(data), H5Sclose);
      hsize_t shape[2] = {0, 0};
      if (space < 0 || H5Sget_simple_extent_ndims(space) != 2 ||
          H5Sget_simple_extent_dims(space, shape, nullptr) != 2 || shape[1] != 4 || shape[0] < 2)
        fail(CONCEG_E_FORMAT, "%s: /%s/%s: expected at least two rows of x y z r", path.c_str(),
             bundle.c_str(), name.c_str());
      check_storage(data, file, path + ": /" + bundle + "/" + name);
      bytes += 32.0 * static_cast<double>(shape[0]);
      if (bytes > static_cast<double>(memory))
        fail(CONCEG_E_NOMEM, "%s: larger than the memory that may be used; raise --memory", path.c_str());
      BundleFibre fibre = {bundle, name, std::vector<double>(shape[0] * 4)};
      if (H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, fibre.row.data()) < 0)
        fail(CONCEG_E_FORMAT, "%s: /%s/%s: cannot be read as numbers", path.c_str(), bundle.c_str(),
             name.c_str());
      fibres.push_back(std::move(fibre));
    }
  }
  if (fibres.empty()) fail(CONCEG_E_FORMAT, "%s: expected bundles of fibres, got none", path.c_str());
  return fibres;
}

} // namespace conceg::importing
