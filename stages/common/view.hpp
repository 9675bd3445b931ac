// SPDX-License-Identifier: BSD-3-Clause
// Typed views of a document's arrays. Reading checks type and row width; a wrong document ends in a clear
// Error.
#pragma once

#include "conceg/doc.h"
#include "guard.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace conceg {

template <class T> struct dtype_of;
template <> struct dtype_of<std::uint8_t> { static constexpr conceg_dtype value = CONCEG_U8; };
template <> struct dtype_of<std::int8_t> { static constexpr conceg_dtype value = CONCEG_I8; };
template <> struct dtype_of<std::uint32_t> { static constexpr conceg_dtype value = CONCEG_U32; };
template <> struct dtype_of<std::int32_t> { static constexpr conceg_dtype value = CONCEG_I32; };
template <> struct dtype_of<std::uint64_t> { static constexpr conceg_dtype value = CONCEG_U64; };
template <> struct dtype_of<std::int64_t> { static constexpr conceg_dtype value = CONCEG_I64; };
template <> struct dtype_of<float> { static constexpr conceg_dtype value = CONCEG_F32; };
template <> struct dtype_of<double> { static constexpr conceg_dtype value = CONCEG_F64; };

// A read-only table of `rows` rows of `columns` values; borrowed from the document.
template <class T> class View {
public:
  View() = default;
  View(const T *data, std::size_t rows, std::size_t columns) : data_(data), rows_(rows), columns_(columns) {}
  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  const T *data() const { return data_; }
  const T *row(std::size_t i) const { return data_ + i * columns_; }
  const T &operator[](std::size_t i) const { return data_[i]; }
  const T *begin() const { return data_; }
  const T *end() const { return data_ + rows_ * columns_; }

private:
  const T *data_ = nullptr;
  std::size_t rows_ = 0, columns_ = 1;
};

// The array at `path`; E_MISSING when it is absent, E_FORMAT when type or width differ. Scalars have one row.
template <class T> View<T> view(conceg_doc *doc, const char *path, std::size_t columns = 1) {
  conceg_array array = {};
  array.size = sizeof array;
  must(conceg_doc_read(doc, path, &array));
  if (array.dtype != dtype_of<T>::value)
    fail(CONCEG_E_FORMAT, "%s: expected type %s, got %s", path, conceg_dtype_name(dtype_of<T>::value),
         conceg_dtype_name(array.dtype));
  std::size_t width = 1;
  for (std::uint32_t axis = 1; axis < array.rank; axis++)
    width *= array.shape[axis];
  const std::size_t rows = array.rank == 0 ? 1 : array.shape[0];
  if (width != columns) {
    if (array.rank == 1 && rows == columns) return {static_cast<const T *>(array.data), 1, columns};
    fail(CONCEG_E_FORMAT, "%s: expected %zu values a row, got %zu", path, columns, width);
  }
  return {static_cast<const T *>(array.data), rows, columns};
}

inline std::vector<std::string> texts(conceg_doc *doc, const char *path) {
  conceg_array array = {};
  array.size = sizeof array;
  must(conceg_doc_read(doc, path, &array));
  if (array.dtype != CONCEG_TEXT)
    fail(CONCEG_E_FORMAT, "%s: expected type text, got %s", path, conceg_dtype_name(array.dtype));
  const auto *strings = static_cast<const char *const *>(array.data);
  return std::vector<std::string>(strings, strings + conceg_array_count(&array));
}

inline bool has(const conceg_doc *doc, const char *path) {
  return conceg_doc_has(doc, path) != 0;
}

// Writes `rows` rows of `columns` values (columns 1 = a vector). The schema gives the unit.
template <class T>
void put(conceg_doc *doc, const char *path, const T *data, std::size_t rows, std::size_t columns = 1) {
  conceg_array array = {};
  array.size = sizeof array;
  array.dtype = dtype_of<T>::value;
  array.rank = columns == 1 ? 1 : 2;
  array.shape[0] = rows;
  array.shape[1] = columns;
  array.data = data;
  must(conceg_doc_write(doc, path, &array));
}
template <class T>
void put(conceg_doc *doc, const char *path, const std::vector<T> &values, std::size_t columns = 1) {
  put(doc, path, values.data(), values.size() / columns, columns);
}
// Three-component vectors (glm::dvec3 and the like): N x 3 doubles.
template <class Vec>
auto put3(conceg_doc *doc, const char *path, const std::vector<Vec> &values) -> decltype(void(values[0].x)) {
  using T = std::decay_t<decltype(values[0].x)>;
  static_assert(sizeof(Vec) == 3 * sizeof(T), "a vector of three components");
  put(doc, path, values.empty() ? nullptr : &values[0].x, values.size(), 3);
}
template <class T> void put_scalar(conceg_doc *doc, const char *path, T value) {
  conceg_array array = {};
  array.size = sizeof array;
  array.dtype = dtype_of<T>::value;
  array.data = &value;
  must(conceg_doc_write(doc, path, &array));
}
inline void put_texts(conceg_doc *doc, const char *path, const std::vector<std::string> &values) {
  std::vector<const char *> strings(values.size());
  std::transform(values.begin(), values.end(), strings.begin(),
                 [](const std::string &s) { return s.c_str(); });
  conceg_array array = {};
  array.size = sizeof array;
  array.dtype = CONCEG_TEXT;
  array.rank = 1;
  array.shape[0] = values.size();
  array.data = strings.data();
  must(conceg_doc_write(doc, path, &array));
}

// Copies an N x 3 array of doubles into a vector of three-component vectors.
template <class Vec> std::vector<Vec> vec3s(conceg_doc *doc, const char *path) {
  const View<double> v = view<double>(doc, path, 3);
  std::vector<Vec> out(v.rows());
  for (std::size_t i = 0; i < out.size(); i++)
    out[i] = Vec(v.row(i)[0], v.row(i)[1], v.row(i)[2]);
  return out;
}

} // namespace conceg
