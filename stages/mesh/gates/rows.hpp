// SPDX-License-Identifier: BSD-3-Clause
// Rows of a document that may be broken: every length and offset is looked at before it is used.
#pragma once

#include "view.hpp"

namespace conceg::gates {

constexpr double kRootReach = 5; // um from the soma's surface to a root

// An array of this type and width, or an empty view when there is none.
template <class T> View<T> rows_of(conceg_doc *doc, const char *path, std::size_t columns = 1) {
  conceg_array array = {};
  array.size = sizeof array;
  if (!has(doc, path) || conceg_doc_read(doc, path, &array) != CONCEG_OK ||
      array.dtype != dtype_of<T>::value || array.rank != (columns == 1 ? 1u : 2u) ||
      (columns > 1 && array.shape[1] != columns))
    return {};
  return {static_cast<const T *>(array.data), array.shape[0], columns};
}

inline std::vector<std::string> texts_of(conceg_doc *doc, const char *path) {
  conceg_array array = {};
  array.size = sizeof array;
  if (!has(doc, path) || conceg_doc_read(doc, path, &array) != CONCEG_OK || array.dtype != CONCEG_TEXT)
    return {};
  return texts(doc, path);
}

// A scalar, or `otherwise`.
template <class T> T scalar_of(conceg_doc *doc, const char *path, T otherwise) {
  conceg_array array = {};
  array.size = sizeof array;
  if (!has(doc, path) || conceg_doc_read(doc, path, &array) != CONCEG_OK ||
      array.dtype != dtype_of<T>::value || conceg_array_count(&array) != 1)
    return otherwise;
  return *static_cast<const T *>(array.data);
}

inline bool ascends(const View<std::uint64_t> &offset, std::size_t groups, std::size_t end) {
  bool sound = offset.rows() == groups + 1 && offset[0] == 0 && offset[groups] == end;
  for (std::size_t i = 0; sound && i < groups; i++)
    sound = offset[i] <= offset[i + 1];
  return sound;
}

struct Cells {
  View<double> soma;
  View<float> radius;
  View<std::uint32_t> type;
  View<std::uint64_t> skeleton_offset;
  std::vector<std::string> class_name; // per type
  bool whole = false;
  explicit Cells(conceg_doc *doc)
      : soma(rows_of<double>(doc, "/cells/soma", 3)), radius(rows_of<float>(doc, "/cells/radius")),
        type(rows_of<std::uint32_t>(doc, "/cells/type")),
        skeleton_offset(rows_of<std::uint64_t>(doc, "/skeleton/cell_offset")),
        class_name(texts_of(doc, "/types/class")) {
    whole = has(doc, "/cells/soma") && radius.rows() == soma.rows() && type.rows() == soma.rows();
    if (skeleton_offset.rows() != soma.rows() + 1) skeleton_offset = {};
  }
  std::size_t rows() const { return whole ? soma.rows() : 0; }
  bool points_of(std::size_t cell) const {
    return skeleton_offset.rows() && skeleton_offset[cell + 1] > skeleton_offset[cell];
  }
  std::string class_of(std::size_t cell) const {
    return type[cell] < class_name.size() ? class_name[type[cell]] : "";
  }
};

struct Skeletons {
  View<std::uint64_t> offset;
  View<double> position;
  View<float> radius;
  View<std::int64_t> parent;
  View<std::uint8_t> kind;
  View<std::uint32_t> branch, bar; // may be empty
  bool whole = false;
  Skeletons(conceg_doc *doc, const Cells &cells)
      : offset(rows_of<std::uint64_t>(doc, "/skeleton/cell_offset")),
        position(rows_of<double>(doc, "/skeleton/position", 3)),
        radius(rows_of<float>(doc, "/skeleton/radius")),
        parent(rows_of<std::int64_t>(doc, "/skeleton/parent")),
        kind(rows_of<std::uint8_t>(doc, "/skeleton/kind")),
        branch(rows_of<std::uint32_t>(doc, "/skeleton/branch")),
        bar(rows_of<std::uint32_t>(doc, "/skeleton/bar")) {
    whole = cells.whole && has(doc, "/skeleton/position") && radius.rows() == points() &&
            parent.rows() == points() && kind.rows() == points() && ascends(offset, cells.rows(), points());
  }
  std::size_t points() const { return position.rows(); }
};

struct Bars {
  View<std::uint64_t> offset;
  View<double> asked_start, asked_end, achieved_start, achieved_end;
  View<std::uint8_t> state;
  bool whole = false;
  Bars(conceg_doc *doc, const Cells &cells)
      : offset(rows_of<std::uint64_t>(doc, "/bars/cell_offset")),
        asked_start(rows_of<double>(doc, "/bars/asked_start")),
        asked_end(rows_of<double>(doc, "/bars/asked_end")),
        achieved_start(rows_of<double>(doc, "/bars/achieved_start")),
        achieved_end(rows_of<double>(doc, "/bars/achieved_end")),
        state(rows_of<std::uint8_t>(doc, "/bars/state")) {
    const std::size_t bars = state.rows();
    whole = cells.whole && has(doc, "/bars/state") && asked_start.rows() == bars &&
            asked_end.rows() == bars && achieved_start.rows() == bars && achieved_end.rows() == bars &&
            ascends(offset, cells.rows(), bars);
  }
};

} // namespace conceg::gates
