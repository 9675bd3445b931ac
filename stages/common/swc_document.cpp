// SPDX-License-Identifier: BSD-3-Clause
#include "swc_document.hpp"

#include "guard.hpp"
#include "swc_values.hpp"
#include "view.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <functional>

namespace conceg::swcdoc {
namespace {

constexpr std::uint64_t most_values = std::uint64_t{1} << 40;

const char *const carried_by_samples[] = {
    "/skeleton/cell_offset", "/skeleton/position",      "/skeleton/radius",  "/skeleton/parent",
    "/skeleton/kind",        "/skeleton/target_radius", "/skeleton/bar",     "/skeleton/branch",
    "/skeleton/tree",        "/skeleton/status",        "/bars/cell_offset", "/spheres/cell_offset"};
const char *const left_out_groups[] = {"/network/", "/meshes/", "/volumes/", "/walkers/"};

bool is_one_of(const std::string &path, const char *const *list, std::size_t count) {
  for (std::size_t i = 0; i < count; i++)
    if (path == list[i]) return true;
  return false;
}
template <std::size_t N> bool is_one_of(const std::string &path, const char *const (&list)[N]) {
  return is_one_of(path, list, N);
}

// ---- Writing ----

conceg_array read(conceg_doc *doc, const std::string &path) {
  conceg_array array = {};
  array.size = sizeof array;
  must(conceg_doc_read(doc, path.c_str(), &array));
  return array;
}

// Rows first .. end of an array; all of it when it has no rows.
void put_rows(std::vector<std::string> &lines, conceg_doc *doc, const std::string &path, std::uint64_t first,
              std::uint64_t end) {
  const conceg_array array = read(doc, path);
  std::uint64_t width = 1;
  std::string shape;
  for (std::uint32_t axis = 0; axis < array.rank; axis++) {
    if (axis) width *= array.shape[axis];
    shape += (axis ? "," : "") + std::to_string(axis ? array.shape[axis] : end - first);
  }
  const std::uint64_t count = array.rank ? (end - first) * width : 1;
  const bool own_unit = path.find('@') == std::string::npos && array.unit;
  lines.push_back("@array " + path + " " + conceg_dtype_name(array.dtype) + " [" + shape + "] " +
                  (own_unit ? quoted(array.unit) : "-"));
  if (array.dtype == CONCEG_TEXT)
    put_texts(lines, static_cast<const char *const *>(array.data) + first * width, count);
  else
    with_type(array.dtype, [&](auto zero) {
      using T = decltype(zero);
      put_numbers<T>(lines, static_cast<const T *>(array.data) + first * width, count);
    });
}

using Visit = std::function<void(const std::string &path)>;

// Every array and attribute at or below a path but @unit; groups end in "/".
void each_array(conceg_doc *doc, const std::string &path, const Visit &visit) {
  const bool group = path.back() == '/';
  if (!group) visit(path);
  if (path.find('@') != std::string::npos) return;
  const std::uint64_t count = conceg_doc_children(doc, path.c_str());
  for (std::uint64_t i = 0; i < count; i++) {
    const std::string child = conceg_doc_child(doc, path.c_str(), i);
    if (!group && child == path + "@unit") continue;
    each_array(doc, child, visit);
  }
}

// Names and types that another tool's groups may have and that the library does not write.
bool can_be_written(conceg_doc *doc, const std::string &path) {
  conceg_array array = {};
  array.size = sizeof array;
  const bool plain = std::all_of(path.begin(), path.end(), [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c)) || std::strchr("/_.+-@", c);
  });
  return plain && conceg_doc_describe(doc, path.c_str(), &array) == CONCEG_OK &&
         (array.dtype != CONCEG_TEXT || array.rank < 2);
}

// Offsets of the group that an array has rows per cell of; null for arrays of the whole document.
struct Rows {
  bool sliced = false;
  std::uint64_t first = 0, end = 0;
};
Rows rows_of(conceg_doc *doc, const std::string &path, const Slices &slices, std::uint64_t cell) {
  Rows rows;
  if (path.find('@') != std::string::npos || is_one_of(path, carried_by_samples)) return rows;
  const std::vector<std::uint64_t> *offset = path.rfind("/bars/", 0) == 0       ? &slices.bars
                                             : path.rfind("/spheres/", 0) == 0  ? &slices.spheres
                                             : path.rfind("/skeleton/", 0) == 0 ? &slices.skeleton
                                                                                : nullptr;
  const bool of_cells = path.rfind("/cells/", 0) == 0;
  if (!of_cells && (!offset || offset->empty())) return rows;
  conceg_array array = {};
  array.size = sizeof array;
  must(conceg_doc_describe(doc, path.c_str(), &array));
  if (!array.rank || array.shape[0] != (of_cells ? slices.cells : offset->back())) return rows;
  rows.sliced = true;
  rows.first = of_cells ? cell : (*offset)[cell], rows.end = of_cells ? cell + 1 : (*offset)[cell + 1];
  return rows;
}

std::vector<std::uint64_t> offsets(conceg_doc *doc, const char *path, std::uint64_t cells) {
  if (!has(doc, path)) return {};
  const View<std::uint64_t> v = view<std::uint64_t>(doc, path);
  std::vector<std::uint64_t> out(v.begin(), v.end());
  bool good = out.size() == cells + 1 && out[0] == 0;
  for (std::size_t i = 1; good && i < out.size(); i++)
    good = out[i] >= out[i - 1];
  if (!good)
    fail(CONCEG_E_FORMAT, "%s: expected %llu ascending offsets from 0", path,
         static_cast<unsigned long long>(cells + 1));
  return out;
}

} // namespace

Slices slices_of(conceg_doc *doc) {
  Slices slices;
  slices.cells = view<std::uint64_t>(doc, "/cells/id").rows();
  slices.bars = offsets(doc, "/bars/cell_offset", slices.cells);
  slices.spheres = offsets(doc, "/spheres/cell_offset", slices.cells);
  slices.skeleton = offsets(doc, "/skeleton/cell_offset", slices.cells);
  return slices;
}

std::vector<std::string> left_out(conceg_doc *doc) {
  std::vector<std::string> out;
  for (const char *group : left_out_groups)
    if (conceg_doc_children(doc, group)) out.push_back(std::string(group, std::strlen(group) - 1));
  const std::uint64_t count = conceg_doc_children(doc, "/");
  for (std::uint64_t i = 0; i < count; i++) {
    const std::string top = conceg_doc_child(doc, "/", i);
    if (is_one_of(top, left_out_groups)) continue;
    each_array(doc, top, [&](const std::string &path) {
      if (!can_be_written(doc, path)) out.push_back(path);
    });
  }
  return out;
}

std::vector<std::string> cell_lines(conceg_doc *doc, const Slices &slices, std::uint64_t cell,
                                    const std::string &digest) {
  const std::uint64_t points =
      slices.skeleton.empty() ? 0 : slices.skeleton[cell + 1] - slices.skeleton[cell];
  std::vector<std::string> lines{"@cgx cell " + digest + " " + std::to_string(cell) + " " +
                                 std::to_string(slices.cells) + " " + std::to_string(points)};
  for (const char *group : {"/cells/", "/bars/", "/skeleton/", "/spheres/"})
    each_array(doc, group, [&](const std::string &path) {
      const Rows rows = can_be_written(doc, path) ? rows_of(doc, path, slices, cell) : Rows();
      if (rows.sliced) put_rows(lines, doc, path, rows.first, rows.end);
    });
  lines.push_back("@cgx end");
  return lines;
}

std::vector<std::string> document_lines(conceg_doc *doc, const Slices &slices, const std::string &digest) {
  static const char *const own[] = {"/@format", "/@version", "/@length_unit", "/@time_unit", "/@complete"};
  std::vector<std::string> lines{"@cgx document " + digest};
  const std::uint64_t count = conceg_doc_children(doc, "/");
  for (std::uint64_t i = 0; i < count; i++) {
    const std::string top = conceg_doc_child(doc, "/", i);
    if (is_one_of(top, own) || is_one_of(top, left_out_groups)) continue;
    each_array(doc, top, [&](const std::string &path) {
      // A skeleton without points has no samples that could carry its arrays.
      const bool by_samples =
          is_one_of(path, carried_by_samples) &&
          !(slices.skeleton.size() && !slices.skeleton.back() && path.rfind("/skeleton/", 0) == 0);
      if (!can_be_written(doc, path) || by_samples || (slices.cells && rows_of(doc, path, slices, 0).sliced))
        return;
      conceg_array array = {};
      array.size = sizeof array;
      must(conceg_doc_describe(doc, path.c_str(), &array));
      put_rows(lines, doc, path, 0, array.rank ? array.shape[0] : 1);
    });
  }
  lines.push_back("@cgx end");
  return lines;
}

// ---- Reading ----

std::uint64_t Array::count() const {
  std::uint64_t n = 1;
  for (std::uint32_t axis = 0; axis < rank; axis++)
    n *= shape[axis];
  return n;
}

namespace {

std::vector<std::string> words_of(const char *text) {
  std::vector<std::string> words;
  const char *p = text;
  while (*p) {
    if (*p == '"') { // the last word may hold blanks
      words.emplace_back(p);
      break;
    }
    const std::size_t length = std::strcspn(p, " ");
    if (length) words.emplace_back(p, length);
    p += length;
    p += std::strspn(p, " ");
  }
  return words;
}

bool read_whole(const std::string &word, std::uint64_t &out) {
  return std::from_chars(word.data(), word.data() + word.size(), out).ptr == word.data() + word.size() &&
         !word.empty();
}

class Reader {
public:
  Reader(const conceg_swc *swc, const std::string &file) : swc_(swc), file_(file) {}

  Blocks read() {
    const char *key, *value;
    for (std::uint32_t i = 0; conceg_swc_header_at(swc_, i, &key, &value); i++) {
      if (!std::strcmp(key, "@cgx"))
        begin_or_end(value);
      else if (!std::strcmp(key, "@array"))
        begin_array(value);
      else if (!std::strcmp(key, "@values"))
        add_values(value);
      else if (!std::strcmp(key, "@text") || !std::strcmp(key, "@more"))
        add_text(key, value);
    }
    if (target_) refuse("expected '@cgx end' before the end of the file, got nothing: the file was cut");
    return std::move(blocks_);
  }

private:
  [[noreturn]] void refuse(const char *what, const std::string &where = "") const {
    fail(CONCEG_E_FORMAT, "%s: %s%s%s; import the cell as a plain SWC by taking the '# @cgx' lines out",
         file_.c_str(), where.c_str(), where.empty() ? "" : ": ", what);
  }

  void begin_or_end(const char *value) {
    const std::vector<std::string> words = words_of(value);
    finish_array();
    if (words.size() == 1 && words[0] == "end" && target_) {
      target_ = nullptr;
      return;
    }
    const bool cell = words.size() == 5 && words[0] == "cell",
               document = words.size() == 2 && words[0] == "document";
    if (target_ || (!cell && !document) || words[1].size() != 64 || (cell && blocks_.present) ||
        (document && blocks_.has_document))
      refuse("expected one block '@cgx cell DIGEST CELL CELLS POINTS' and at most one '@cgx document DIGEST'",
             std::string("@cgx ") + value);
    if (!blocks_.digest.empty() && blocks_.digest != words[1]) refuse("the blocks are of two documents");
    blocks_.digest = words[1];
    if (cell && (!read_whole(words[2], blocks_.cell) || !read_whole(words[3], blocks_.cells) ||
                 !read_whole(words[4], blocks_.points) || blocks_.cell >= blocks_.cells))
      refuse("expected the number of the cell, of all cells and of points", std::string("@cgx ") + value);
    (cell ? blocks_.present : blocks_.has_document) = true;
    target_ = cell ? &blocks_.of_cell : &blocks_.of_document;
  }

  void begin_array(const char *value) {
    finish_array();
    if (!target_) refuse("an array outside of a block", value);
    const std::vector<std::string> words = words_of(value);
    Array array;
    if (words.size() != 4 || words[0][0] != '/')
      refuse("expected '@array PATH TYPE [SHAPE] \"UNIT\"'", value);
    array.path = words[0], array.dtype = dtype_named(words[1]);
    if (array.dtype == CONCEG_DTYPE_MAXIMUM) refuse("expected a type such as f64", value);
    array.has_unit = words[3] != "-";
    if (array.has_unit && !unquote(words[3], array.unit)) refuse("expected a quoted unit or -", value);
    read_shape(words[2], array, value);
    target_->push_back(std::move(array));
    open_ = true;
  }

  void read_shape(const std::string &text, Array &array, const char *value) {
    if (text.size() < 2 || text.front() != '[' || text.back() != ']')
      refuse("expected a shape such as [12,3]", value);
    std::string rest = text.substr(1, text.size() - 2);
    std::uint64_t total = 1;
    while (!rest.empty()) {
      const std::size_t comma = rest.find(',');
      const std::string word = rest.substr(0, comma);
      std::uint64_t extent;
      if (array.rank == 4 || !read_whole(word, extent) || (extent && total > most_values / extent))
        refuse("expected at most four extents with at most 2^40 values", value);
      total *= extent;
      array.shape[array.rank++] = extent;
      rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
    }
  }

  void add_values(const char *value) {
    if (!open_ || target_->back().dtype == CONCEG_TEXT)
      refuse("values outside of an array of numbers", value);
    Array &array = target_->back();
    bool good = false;
    with_type(array.dtype, [&](auto zero) { good = read_numbers<decltype(zero)>(value, array.bytes); });
    if (!good) refuse("expected numbers of its type", array.path);
  }

  void add_text(const char *key, const char *value) {
    if (!open_ || target_->back().dtype != CONCEG_TEXT) refuse("text outside of an array of texts", value);
    Array &array = target_->back();
    if (!std::strcmp(key, "@text"))
      array.texts.emplace_back();
    else if (array.texts.empty())
      refuse("expected '@text' before '@more'", array.path);
    if (!unquote(value, array.texts.back())) refuse("expected a quoted text", array.path);
  }

  void finish_array() {
    if (!open_) return;
    open_ = false;
    const Array &array = target_->back();
    const std::uint64_t got = array.dtype == CONCEG_TEXT
                                  ? array.texts.size()
                                  : array.bytes.size() / conceg_dtype_bytes(array.dtype);
    if (got != array.count())
      refuse(("expected " + std::to_string(array.count()) + " values, got " + std::to_string(got)).c_str(),
             array.path);
  }

  const conceg_swc *swc_;
  const std::string &file_;
  Blocks blocks_;
  std::vector<Array> *target_ = nullptr;
  bool open_ = false;
};

} // namespace

Blocks read_blocks(const conceg_swc *swc, const std::string &file) {
  return Reader(swc, file).read();
}

void put_array(conceg_doc *doc, const Array &array) {
  conceg_array out = {};
  std::vector<const char *> strings;
  out.size = sizeof out, out.dtype = array.dtype, out.rank = array.rank;
  std::copy(array.shape, array.shape + 4, out.shape);
  for (const std::string &text : array.texts)
    strings.push_back(text.c_str());
  out.data = array.dtype == CONCEG_TEXT ? static_cast<const void *>(strings.data()) : array.bytes.data();
  if (array.has_unit) out.unit = array.unit.c_str();
  must(conceg_doc_write(doc, array.path.c_str(), &out));
}

} // namespace conceg::swcdoc
