// SPDX-License-Identifier: BSD-3-Clause
// SWC-plus -> document: the blocks give back what they hold, the samples give the skeletons.
#include "swc_files.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace conceg::importing {
namespace {

using swcdoc::Array;

const char *const optional_columns[] = {"target_radius", "bar", "branch", "tree", "status"};
constexpr std::size_t optional_count = 5;

// The skeletons of all cells, row by row.
struct Skeletons {
  std::vector<std::uint64_t> cell_offset{0};
  std::vector<double> position;
  std::vector<float> radius;
  std::vector<std::int64_t> parent;
  std::vector<std::uint8_t> kind;
  std::vector<double> column[optional_count];
  bool has_column[optional_count] = {true, true, true, true, true};
};

// Place of every sample among the document's rows of the cell; empty when the samples are not those of the
// document.
std::vector<std::size_t> rows_of(const SwcFile &file) {
  const std::size_t count = conceg_swc_count(file.swc.get());
  const double *column = conceg_swc_column(file.swc.get(), "row");
  const std::int64_t *parent = conceg_swc_parent(file.swc.get());
  if (count != file.blocks.points || (count && !column)) return {};
  std::vector<std::size_t> row(count);
  std::vector<char> taken(count, 0);
  for (std::size_t i = 0; i < count; i++) {
    if (!(column[i] >= 0.0 && column[i] < static_cast<double>(count)) || column[i] != std::floor(column[i]))
      return {};
    row[i] = static_cast<std::size_t>(column[i]);
    if (taken[row[i]]++ || (parent[i] >= 0 && row[static_cast<std::size_t>(parent[i])] >= row[i])) return {};
  }
  return row;
}

// SWC codes beyond those of CGX, which another tool may have written.
std::uint8_t kind_of(int code) {
  return static_cast<std::uint8_t>(code == 2 || code == 3 || code == 4 || code == 7 ? code : 3);
}

// What a new sample has no value for is taken from its parent.
double filled(const char *name, const double *column, const std::vector<double> &before, std::size_t i,
              std::int64_t up, double radius) {
  if (column && !std::isnan(column[i])) return column[i];
  if (name[0] == 't' && name[1] == 'a') return radius; // target_radius
  return up >= 0 ? before[static_cast<std::size_t>(up)] : 0.0;
}

// Samples whose type or parent is another than in the document; says so once a file.
bool links_changed(conceg_ctx *ctx, const SwcFile &file, const std::vector<std::size_t> &row) {
  const conceg_swc *swc = file.swc.get();
  const double *kind = conceg_swc_column(swc, "kind"), *parent_row = conceg_swc_column(swc, "parent_row");
  const std::int64_t *parent = conceg_swc_parent(swc);
  std::size_t changed = 0;
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < row.size(); i++) {
    const double up = parent[i] < 0 ? -1.0 : static_cast<double>(row[static_cast<std::size_t>(parent[i])]);
    if (kind && parent_row && kind[i] == conceg_swc_kind(swc)[i] && parent_row[i] == up) continue;
    const std::uint32_t line = conceg_swc_line(swc)[i];
    first = changed++ ? std::min(first, line) : line;
  }
  if (changed)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "%s:%u: W_STALE: type or parent of %zu samples, here the first, is another than in the "
                   "document; the file as it is now is taken",
                   file.path.c_str(), first, changed);
  return changed != 0;
}

// Returns whether the rows are those of the document.
bool add_cell(Skeletons &all, const SwcFile &file, const std::vector<std::size_t> &old_row) {
  const conceg_swc *swc = file.swc.get();
  const std::size_t count = conceg_swc_count(swc), first = all.radius.size();
  std::vector<std::size_t> row = old_row;
  const bool kept = row.size() == count && count == file.blocks.points;
  if (!kept) {
    row.resize(count);
    for (std::size_t i = 0; i < count; i++)
      row[i] = i;
  }
  all.position.resize(3 * (first + count)), all.radius.resize(first + count),
      all.parent.resize(first + count), all.kind.resize(first + count);
  const double *position = conceg_swc_position(swc), *radius = conceg_swc_radius(swc);
  const std::int64_t *parent = conceg_swc_parent(swc);
  for (std::size_t i = 0; i < count; i++) {
    const std::size_t at = first + row[i];
    if (!(radius[i] > 0.0))
      fail(CONCEG_E_RANGE, "%s:%u: expected a radius above 0, got %g; conceg swc repair raises it",
           file.path.c_str(), conceg_swc_line(swc)[i], radius[i]);
    for (std::size_t k = 0; k < 3; k++)
      all.position[3 * at + k] = position[3 * i + k];
    all.radius[at] = static_cast<float>(radius[i]);
    all.parent[at] = parent[i] < 0 ? -1 : static_cast<std::int64_t>(row[static_cast<std::size_t>(parent[i])]);
    all.kind[at] = kind_of(conceg_swc_kind(swc)[i]);
  }
  for (std::size_t c = 0; c < optional_count; c++) {
    const double *column = conceg_swc_column(swc, optional_columns[c]);
    if (!column && kept && count) all.has_column[c] = false;
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; i++)
      values[i] = filled(optional_columns[c], column, values, i, parent[i], radius[i]);
    all.column[c].resize(first + count);
    for (std::size_t i = 0; i < count; i++)
      all.column[c][first + row[i]] = values[i];
  }
  all.cell_offset.push_back(all.radius.size());
  return kept;
}

template <class T> void put_column(conceg_doc *doc, const char *path, const std::vector<double> &values) {
  std::vector<T> out(values.size());
  for (std::size_t i = 0; i < values.size(); i++)
    out[i] = static_cast<T>(
        std::min(std::max(values[i], 0.0), static_cast<double>(std::numeric_limits<T>::max())));
  put(doc, path, out);
}

void write_skeletons(conceg_doc *doc, const Skeletons &s) {
  put(doc, "/skeleton/cell_offset", s.cell_offset);
  put(doc, "/skeleton/position", s.position, 3);
  put(doc, "/skeleton/radius", s.radius);
  put(doc, "/skeleton/parent", s.parent);
  put(doc, "/skeleton/kind", s.kind);
  if (s.has_column[0]) put_column<float>(doc, "/skeleton/target_radius", s.column[0]);
  if (!s.has_column[0]) put(doc, "/skeleton/target_radius", s.radius);
  if (s.has_column[1]) put_column<std::uint32_t>(doc, "/skeleton/bar", s.column[1]);
  if (s.has_column[2]) put_column<std::uint32_t>(doc, "/skeleton/branch", s.column[2]);
  if (s.has_column[3]) put_column<std::uint32_t>(doc, "/skeleton/tree", s.column[3]);
  if (s.has_column[4]) put_column<std::uint8_t>(doc, "/skeleton/status", s.column[4]);
}

// The rows of all cells, one after the other, as one array per path; offsets for the groups that have some.
void write_slices(conceg_doc *doc, std::vector<SwcFile> &files, bool skeleton_rows_kept) {
  std::map<std::string, Array> whole;
  std::map<std::string, std::vector<std::uint64_t>> offset;
  for (SwcFile &file : files) {
    std::map<std::string, std::uint64_t> rows;
    for (Array &slice : file.blocks.of_cell) {
      const std::string group = slice.path.substr(0, slice.path.find('/', 1));
      if (!slice.rank)
        fail(CONCEG_E_FORMAT, "%s: %s: expected rows of the cell, got a single value", file.path.c_str(),
             slice.path.c_str());
      const auto seen = rows.emplace(group, slice.shape[0]);
      if (!seen.second && seen.first->second != slice.shape[0])
        fail(CONCEG_E_FORMAT, "%s: %s: expected %llu rows as in the other arrays of its group, got %llu",
             file.path.c_str(), slice.path.c_str(), static_cast<unsigned long long>(seen.first->second),
             static_cast<unsigned long long>(slice.shape[0]));
      Array &array = whole[slice.path];
      if (array.path.empty()) {
        array = slice;
        continue;
      }
      if (array.dtype != slice.dtype || array.rank != slice.rank ||
          !std::equal(array.shape + 1, array.shape + 4, slice.shape + 1))
        fail(CONCEG_E_FORMAT, "%s: %s: type or shape differs from that in the other files", file.path.c_str(),
             slice.path.c_str());
      array.shape[0] += slice.shape[0];
      array.bytes.insert(array.bytes.end(), slice.bytes.begin(), slice.bytes.end());
      array.texts.insert(array.texts.end(), slice.texts.begin(), slice.texts.end());
    }
    for (const char *group : {"/bars", "/spheres"}) {
      std::vector<std::uint64_t> &o = offset[group];
      if (o.empty()) o.push_back(0);
      o.push_back(o.back() + (rows.count(group) ? rows[group] : 0));
    }
    file.blocks.of_cell.clear();
  }
  for (auto &[path, array] : whole)
    if (skeleton_rows_kept || path.rfind("/skeleton/", 0) != 0) swcdoc::put_array(doc, array);
  for (const auto &[group, o] : offset)
    if (conceg_doc_children(doc, group.c_str())) put(doc, (group + "/cell_offset").c_str(), o);
}

// A soma that was moved, resized or taken away in its file. Returns whether there is one.
bool take_somas(conceg_ctx *ctx, conceg_doc *doc, const std::vector<SwcFile> &files) {
  const View<double> old_soma = view<double>(doc, "/cells/soma", 3);
  const View<float> old_radius = view<float>(doc, "/cells/radius");
  if (old_soma.rows() != files.size() || old_radius.rows() != files.size())
    fail(CONCEG_E_FORMAT, "/cells: expected a row for each of %zu files, got %zu", files.size(),
         old_soma.rows());
  std::vector<double> soma(old_soma.begin(), old_soma.end());
  std::vector<float> radius(old_radius.begin(), old_radius.end());
  bool edited = false;
  for (std::size_t i = 0; i < files.size(); i++) {
    double center[3], r;
    if (conceg_swc_soma(files[i].swc.get(), center, &r) == CONCEG_SOMA_NONE)
      r = 0.0; // it keeps its place
    else
      std::copy(center, center + 3, &soma[3 * i]);
    radius[i] = static_cast<float>(r);
    if (radius[i] == old_radius[i] && std::equal(&soma[3 * i], &soma[3 * i] + 3, old_soma.row(i))) continue;
    edited = true;
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "%s: W_STALE: the soma is another than in the document; the file as it is now is taken",
                   files[i].path.c_str());
  }
  put(doc, "/cells/soma", soma, 3);
  put(doc, "/cells/radius", radius);
  return edited;
}

void check_set(std::vector<SwcFile> &files) {
  const SwcFile *document = nullptr, *with = nullptr, *without = nullptr;
  for (const SwcFile &file : files) {
    (file.blocks.present ? with : without) = &file;
    if (file.blocks.has_document) document = &file;
  }
  if (without)
    fail(CONCEG_E_FORMAT, "%s: is a plain SWC file, while %s carries a part of a document; import them apart",
         without->path.c_str(), with->path.c_str());
  for (const SwcFile &file : files)
    if (file.blocks.digest != files[0].blocks.digest || file.blocks.cells != files[0].blocks.cells)
      fail(CONCEG_E_FORMAT, "%s and %s are of two documents; import them apart", files[0].path.c_str(),
           file.path.c_str());
  if (!document)
    fail(CONCEG_E_MISSING,
         "%s: the file of cell 0, which holds what belongs to all cells, is not among the %zu files",
         files[0].path.c_str(), files.size());
  std::sort(files.begin(), files.end(),
            [](const SwcFile &a, const SwcFile &b) { return a.blocks.cell < b.blocks.cell; });
  for (std::size_t i = 1; i < files.size(); i++)
    if (files[i].blocks.cell == files[i - 1].blocks.cell)
      fail(CONCEG_E_FORMAT, "%s and %s are both cell %llu of the document", files[i - 1].path.c_str(),
           files[i].path.c_str(), static_cast<unsigned long long>(files[i].blocks.cell));
}

// Whether groups that this version does not know still fit the cells cannot be told.
void drop_unknown(conceg_ctx *ctx, conceg_doc *doc) {
  std::vector<std::string> unknown;
  for (std::uint64_t i = 0; i < conceg_doc_children(doc, "/"); i++) {
    const std::string path = conceg_doc_child(doc, "/", i), name = path.substr(1, path.find('/', 1) - 1);
    if (path.find('@') == std::string::npos && name.rfind("x_", 0) != 0 &&
        std::find(std::begin(known_groups), std::end(known_groups), name) == std::end(known_groups))
      unknown.push_back("/" + name);
  }
  for (const std::string &group : unknown) {
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "import: %s is left out: the cells were edited, and this version does not know whether it "
                   "still fits them",
                   group.c_str());
    must(conceg_doc_drop(doc, group.c_str()));
  }
}

} // namespace

bool restore_document(conceg_ctx *ctx, conceg_doc *doc, std::vector<SwcFile> &files) {
  check_set(files);
  const std::uint64_t cells = files[0].blocks.cells;
  bool edited = files.size() < cells, rows_kept = true;
  if (edited)
    conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                   "import: %llu of the document's %llu cells have no file here and are left out",
                   static_cast<unsigned long long>(cells - files.size()),
                   static_cast<unsigned long long>(cells));
  Skeletons skeletons;
  for (const SwcFile &file : files) {
    const std::vector<std::size_t> row = rows_of(file);
    const bool kept = add_cell(skeletons, file, row);
    if (!kept)
      conceg_ctx_log(
          ctx, CONCEG_LOG_WARNING,
          "%s: samples were added, removed or put in another order: the file as it is now is taken",
          file.path.c_str());
    rows_kept = rows_kept && kept;
    edited = (kept && links_changed(ctx, file, row)) || edited || !kept || file.stale;
  }
  for (SwcFile &file : files)
    for (const Array &array : file.blocks.of_document)
      swcdoc::put_array(doc, array);
  write_slices(doc, files, rows_kept);
  if (skeletons.radius.empty() && has(doc, "/skeleton/position"))
    put(doc, "/skeleton/cell_offset", skeletons.cell_offset);
  else
    write_skeletons(doc, skeletons);
  edited = take_somas(ctx, doc, files) || edited;
  if (!edited) return true;
  for (const char *group : {"/spheres", "/statistics"}) {
    if (conceg_doc_has(doc, group))
      conceg_ctx_log(ctx, CONCEG_LOG_WARNING,
                     "import: %s is left out: the cells that it was made from were edited", group);
    must(conceg_doc_drop(doc, group));
  }
  drop_unknown(ctx, doc);
  return false;
}

} // namespace conceg::importing
