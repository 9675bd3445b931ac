// SPDX-License-Identifier: BSD-3-Clause
#include "table.hpp"

#include "guard.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <map>
#include <set>
#include <sstream>

namespace conceg::characterise {
namespace {

enum Name {
  file,
  entry,
  class_,
  donor_id,
  fold,
  frame,
  soma_radius_um,
  axon,
  source,
  pooled_from,
  note,
  names
};
const char *const column_names[names] = {"file",           "entry", "class",  "donor_id",    "fold", "frame",
                                         "soma_radius_um", "axon",  "source", "pooled_from", "note"};
const char *const class_names[] = {"pyramidal", "interneuron", "astrocyte", "microglia", "axon", "other"};
const char *const frame_names[] = {"apical", "+x", "-x", "+y", "-y", "+z", "-z", "unknown"};

template <std::size_t N> bool one_of(const std::string &word, const char *const (&list)[N]) {
  return std::any_of(list, list + N, [&](const char *name) { return word == name; });
}

double number(const std::string &field, double fallback, double lo, double hi, const char *what,
              const std::string &name, std::size_t line) {
  if (field.empty()) return fallback;
  std::istringstream in(field);
  in.imbue(std::locale::classic());
  double value;
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof() || !(value >= lo && value <= hi))
    fail(CONCEG_E_RANGE, "%s:%zu: %s: expected a number from %g to %g, got '%s'", name.c_str(), line, what,
         lo, hi, field.c_str());
  return value;
}

// Lines that are neither empty nor remarks, with their numbers; the first one is the header.
struct Line {
  std::size_t number;
  std::vector<std::string> fields;
};
std::vector<Line> read_lines(const std::string &text, const std::string &name) {
  std::vector<Line> lines;
  std::istringstream in(text);
  std::string line;
  for (std::size_t number_of_line = 1; std::getline(in, line); number_of_line++) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    lines.push_back({number_of_line, split_csv(line)});
    if (lines.back().fields.size() != lines.front().fields.size())
      fail(CONCEG_E_FORMAT, "%s:%zu: expected %zu columns as in the header, got %zu", name.c_str(),
           number_of_line, lines.front().fields.size(), lines.back().fields.size());
  }
  return lines;
}

std::string joined(const char *const *words, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; i++)
    out += (i ? ", " : "") + std::string(words[i]);
  return out;
}

// The place of each named column, or -1. Every name of the header must be known, once.
std::vector<std::ptrdiff_t> find_columns(const Line &header, const char *const *known, std::size_t count,
                                         std::size_t required, const std::string &name) {
  std::vector<std::ptrdiff_t> place(count, -1);
  for (std::size_t column = 0; column < header.fields.size(); column++) {
    const auto found = std::find(known, known + count, header.fields[column]);
    if (found == known + count || place[static_cast<std::size_t>(found - known)] >= 0)
      fail(CONCEG_E_FORMAT, "%s:%zu: expected a header of %s, each once, got '%s'", name.c_str(),
           header.number, joined(known, count).c_str(), header.fields[column].c_str());
    place[static_cast<std::size_t>(found - known)] = static_cast<std::ptrdiff_t>(column);
  }
  for (std::size_t i = 0; i < required; i++)
    if (place[i] < 0)
      fail(CONCEG_E_FORMAT, "%s:%zu: expected a column %s in the header, got none", name.c_str(),
           header.number, known[i]);
  return place;
}

TableRow read_row(const std::vector<std::string> &fields, const std::vector<std::ptrdiff_t> &place,
                  const std::string &name, std::size_t line) {
  const auto field = [&](Name column) {
    return place[column] < 0 ? std::string() : fields[static_cast<std::size_t>(place[column])];
  };
  TableRow row;
  row.line = line;
  row.file = field(file), row.entry = field(entry), row.cell_class = field(class_),
  row.donor_id = field(donor_id);
  row.frame = field(frame).empty() ? "unknown" : field(frame), row.note = field(note);
  row.source = field(source), row.pooled_from = field(pooled_from);
  row.fold = static_cast<unsigned>(number(field(fold), 0.0, 0.0, 255.0, "fold", name, line));
  row.soma_radius_um = number(field(soma_radius_um), -1.0, 1e-3, 1e3, "soma_radius_um", name, line);
  row.whole_axon = field(axon) == "full";
  if (!row.whole_axon && !field(axon).empty())
    fail(CONCEG_E_FORMAT, "%s:%zu: axon: expected full or nothing, got '%s'", name.c_str(), line,
         field(axon).c_str());
  if (row.entry.empty())
    fail(CONCEG_E_FORMAT, "%s:%zu: entry: expected a name, got nothing", name.c_str(), line);
  if (!one_of(row.cell_class, class_names))
    fail(CONCEG_E_FORMAT,
         "%s:%zu: class: expected pyramidal, interneuron, astrocyte, microglia, axon or other, got '%s'",
         name.c_str(), line, row.cell_class.c_str());
  if (!one_of(row.frame, frame_names))
    fail(CONCEG_E_FORMAT, "%s:%zu: frame: expected apical, +x, -x, +y, -y, +z, -z or unknown, got '%s'",
         name.c_str(), line, row.frame.c_str());
  return row;
}

} // namespace

std::vector<std::string> split_csv(const std::string &line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); i++) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

std::vector<TableRow> parse_table(const std::string &text, const std::string &name) {
  const std::vector<Line> lines = read_lines(text, name);
  std::vector<TableRow> rows;
  std::set<std::string> closed;
  std::map<std::string, unsigned> fold_of; // by file
  std::vector<std::ptrdiff_t> place;
  if (!lines.empty()) place = find_columns(lines[0], column_names, names, 3, name);
  for (std::size_t i = 1; i < lines.size(); i++) {
    const std::size_t line = lines[i].number;
    TableRow row = read_row(lines[i].fields, place, name, line);
    if (rows.empty() || rows.back().entry != row.entry) {
      if (!closed.insert(row.entry).second)
        fail(CONCEG_E_FORMAT, "%s:%zu: entry %s stands in two places; keep its rows together", name.c_str(),
             line, row.entry.c_str());
    } else if (rows.back().cell_class != row.cell_class)
      fail(CONCEG_E_FORMAT, "%s:%zu: class: expected %s as in the entry's other rows, got %s", name.c_str(),
           line, rows.back().cell_class.c_str(), row.cell_class.c_str());
    // A cell that serves in two entries must not be held back in one and used in the other.
    if (!row.file.empty() && fold_of.emplace(row.file, row.fold).first->second != row.fold)
      fail(CONCEG_E_FORMAT, "%s:%zu: fold: expected %u as in the other row of %s, got %u", name.c_str(), line,
           fold_of[row.file], row.file.c_str(), row.fold);
    rows.push_back(std::move(row));
  }
  if (rows.empty()) fail(CONCEG_E_FORMAT, "%s: expected rows of files, got none", name.c_str());
  return rows;
}

std::vector<Source> parse_sources(const std::string &text, const std::string &name) {
  const char *const columns[] = {"source", "repository", "licence", "terms"};
  const std::vector<Line> lines = read_lines(text, name);
  if (lines.size() < 2) fail(CONCEG_E_FORMAT, "%s: expected rows of sources, got none", name.c_str());
  const std::vector<std::ptrdiff_t> place = find_columns(lines[0], columns, 4, 4, name);
  std::vector<Source> out;
  std::set<std::string> taken;
  for (std::size_t i = 1; i < lines.size(); i++) {
    const auto field = [&](std::size_t column) {
      return lines[i].fields[static_cast<std::size_t>(place[column])];
    };
    if (field(0).empty() || !taken.insert(field(0)).second)
      fail(CONCEG_E_FORMAT, "%s:%zu: source: expected a name that no other row has, got '%s'", name.c_str(),
           lines[i].number, field(0).c_str());
    out.push_back({field(0), field(1), field(2), field(3)});
  }
  return out;
}

} // namespace conceg::characterise
