// SPDX-License-Identifier: BSD-3-Clause
#include "table.hpp"

#include "guard.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <set>
#include <sstream>

namespace conceg::characterise {
namespace {

const char *const column_names[] = {"file",  "entry",          "class", "donor_id", "fold",
                                    "frame", "soma_radius_um", "axon",  "note"};
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

TableRow read_row(const std::vector<std::string> &fields, const std::string &name, std::size_t line) {
  TableRow row;
  row.line = line;
  row.file = fields[0], row.entry = fields[1], row.cell_class = fields[2], row.donor_id = fields[3];
  row.frame = fields[5].empty() ? "unknown" : fields[5], row.note = fields[8];
  row.fold = static_cast<unsigned>(number(fields[4], 0.0, 0.0, 255.0, "fold", name, line));
  row.soma_radius_um = number(fields[6], -1.0, 1e-3, 1e3, "soma_radius_um", name, line);
  row.whole_axon = fields[7] == "full";
  if (!row.whole_axon && !fields[7].empty())
    fail(CONCEG_E_FORMAT, "%s:%zu: axon: expected full or nothing, got '%s'", name.c_str(), line,
         fields[7].c_str());
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
  constexpr std::size_t width = sizeof column_names / sizeof *column_names;
  std::vector<TableRow> rows;
  std::set<std::string> closed;
  std::istringstream in(text);
  std::string line;
  bool header = false;
  for (std::size_t number_of_line = 1; std::getline(in, line); number_of_line++) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> fields = split_csv(line);
    if (fields.size() != width)
      fail(CONCEG_E_FORMAT, "%s:%zu: expected %zu columns, got %zu", name.c_str(), number_of_line, width,
           fields.size());
    if (!header) {
      header = true;
      if (!std::equal(fields.begin(), fields.end(), column_names))
        fail(CONCEG_E_FORMAT,
             "%s:%zu: expected the header file,entry,class,donor_id,fold,frame,soma_radius_um,axon,note",
             name.c_str(), number_of_line);
      continue;
    }
    TableRow row = read_row(fields, name, number_of_line);
    if (rows.empty() || rows.back().entry != row.entry) {
      if (!closed.insert(row.entry).second)
        fail(CONCEG_E_FORMAT, "%s:%zu: entry %s stands in two places; keep its rows together", name.c_str(),
             number_of_line, row.entry.c_str());
    } else if (rows.back().cell_class != row.cell_class)
      fail(CONCEG_E_FORMAT, "%s:%zu: class: expected %s as in the entry's other rows, got %s", name.c_str(),
           number_of_line, rows.back().cell_class.c_str(), row.cell_class.c_str());
    rows.push_back(std::move(row));
  }
  if (rows.empty()) fail(CONCEG_E_FORMAT, "%s: expected rows of files, got none", name.c_str());
  return rows;
}

} // namespace conceg::characterise
