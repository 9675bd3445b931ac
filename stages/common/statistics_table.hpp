// SPDX-License-Identifier: BSD-3-Clause
// Tables of text and numbers, as they go to /statistics, to the log and to files.
#pragma once

#include "conceg/doc.h"

#include <cstdint>
#include <string>
#include <vector>

namespace conceg {

struct Column {
  enum Type { text, whole, real } type;
  std::string name, unit;
  std::vector<std::string> texts;
  std::vector<std::uint64_t> wholes;
  std::vector<double> reals;
  std::size_t rows() const {
    return type == text ? texts.size() : type == whole ? wholes.size() : reals.size();
  }
};

class Table {
public:
  explicit Table(std::string table_name) : name(std::move(table_name)) {}
  // Adds one value to the named column, which is made when it is new. All columns must end with the same
  // number of rows.
  void put(const char *column, const std::string &value) {
    at(column, Column::text, "").texts.push_back(value);
  }
  void put(const char *column, std::uint64_t value) { at(column, Column::whole, "").wholes.push_back(value); }
  void put(const char *column, double value, const char *unit) {
    at(column, Column::real, unit).reals.push_back(value);
  }
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().rows(); }
  // The table as lines of aligned text: the names, then the rows.
  std::vector<std::string> lines() const;
  // Comma-separated values (RFC 4180): a line of names with units, as length_um, then the rows; numbers read
  // back as the same double.
  std::string csv() const;

  std::string name;
  std::vector<Column> columns;

private:
  Column &at(const char *column, Column::Type type, const char *unit);
};

// Puts the table into the document as /statistics/<name>, in place of an earlier one.
void write_table(conceg_doc *doc, const Table &table);

} // namespace conceg
