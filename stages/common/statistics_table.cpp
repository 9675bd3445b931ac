// SPDX-License-Identifier: BSD-3-Clause
#include "statistics_table.hpp"

#include "guard.hpp"
#include "view.hpp"

#include <algorithm>
#include <cstdio>

namespace conceg {

namespace {

std::string written(const Column &column, std::size_t row) {
  char number[40];
  if (column.type == Column::text) return column.texts[row];
  if (column.type == Column::whole)
    std::snprintf(number, sizeof number, "%llu", static_cast<unsigned long long>(column.wholes[row]));
  else
    std::snprintf(number, sizeof number, "%.5g", column.reals[row]);
  return number;
}

} // namespace

Column &Table::at(const char *column, Column::Type type, const char *unit) {
  for (Column &c : columns)
    if (c.name == column) {
      if (c.type != type) fail(CONCEG_E_INTERNAL, "table %s: column %s has two types", name.c_str(), column);
      return c;
    }
  Column made = {type, column, unit, {}, {}, {}};
  columns.push_back(made);
  return columns.back();
}

std::vector<std::string> Table::lines() const {
  std::vector<std::string> out(rows() + 1);
  for (const Column &column : columns) {
    const std::string title =
        column.unit.empty() || column.unit == "1" ? column.name : column.name + " [" + column.unit + "]";
    std::size_t width = title.size();
    for (std::size_t row = 0; row < rows(); row++)
      width = std::max(width, written(column, row).size());
    const auto add = [&](std::string &line, const std::string &cell) {
      const std::string padding(width - cell.size(), ' ');
      if (!line.empty()) line += "  ";
      line += column.type == Column::text ? cell + padding : padding + cell;
    };
    add(out[0], title);
    for (std::size_t row = 0; row < rows(); row++)
      add(out[row + 1], written(column, row));
  }
  for (std::string &line : out)
    line.erase(line.find_last_not_of(' ') + 1);
  return out;
}

std::string Table::csv() const {
  std::string out;
  const auto field = [&](const std::string &text, bool first) {
    if (!first) out += ',';
    if (text.find_first_of(",\"\n\r") == std::string::npos) {
      out += text;
      return;
    }
    out += '"';
    for (const char c : text)
      out += c == '"' ? std::string("\"\"") : std::string(1, c);
    out += '"';
  };
  for (const Column &column : columns) {
    std::string unit = column.unit == "1" ? "" : column.unit;
    unit.erase(std::remove(unit.begin(), unit.end(), '^'), unit.end());
    field(unit.empty() ? column.name : column.name + "_" + unit, &column == &columns.front());
  }
  out += '\n';
  for (std::size_t row = 0; row < rows(); row++) {
    for (const Column &column : columns) {
      char number[40];
      std::snprintf(number, sizeof number, "%.17g", column.type == Column::real ? column.reals[row] : 0.0);
      field(column.type == Column::real ? number : written(column, row), &column == &columns.front());
    }
    out += '\n';
  }
  return out;
}

void write_table(conceg_doc *doc, const Table &table) {
  for (const Column &column : table.columns) {
    const std::string path = "/statistics/" + table.name + "/" + column.name;
    std::vector<const char *> strings(column.texts.size());
    std::transform(column.texts.begin(), column.texts.end(), strings.begin(),
                   [](const std::string &s) { return s.c_str(); });
    conceg_array array = {};
    array.size = sizeof array;
    array.rank = 1;
    array.shape[0] = column.rows();
    array.unit = column.unit.c_str();
    array.dtype = column.type == Column::text    ? CONCEG_TEXT
                  : column.type == Column::whole ? CONCEG_U64
                                                 : CONCEG_F64;
    array.data = column.type == Column::text    ? static_cast<const void *>(strings.data())
                 : column.type == Column::whole ? static_cast<const void *>(column.wholes.data())
                                                : static_cast<const void *>(column.reals.data());
    must(conceg_doc_write(doc, path.c_str(), &array));
  }
}

} // namespace conceg
