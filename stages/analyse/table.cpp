// SPDX-License-Identifier: BSD-3-Clause
#include "table.hpp"

#include "guard.hpp"

#include <algorithm>
#include <cstdio>

namespace conceg::analyse {

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

} // namespace conceg::analyse
