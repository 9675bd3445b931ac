// SPDX-License-Identifier: BSD-3-Clause
// The table that groups files into entries of the dictionary (comma separated, README.md).
#pragma once

#include <string>
#include <vector>

namespace conceg::characterise {

struct TableRow {
  std::size_t line = 0;
  std::string file; // empty: the row gives the entry's note
  std::string entry, cell_class, donor_id, frame, note;
  std::string source;      // row of the table of sources; may be empty
  std::string pooled_from; // where a donor of another group was taken from; empty = the entry's own
  unsigned fold = 0;
  double soma_radius_um = -1.0; // -1 = as in the file
  bool whole_axon = false;      // the axon was traced to its ends
};

// The header names the columns, in any order; file, entry and class must be there. Throws conceg::Error with
// `name`:line. Rows of one entry must stand together.
std::vector<TableRow> parse_table(const std::string &text, const std::string &name);

// Fields of one comma-separated line; "quoted, fields" and "" inside them are understood.
std::vector<std::string> split_csv(const std::string &line);

// Where donors come from, and what their authors ask for.
struct Source {
  std::string name, repository, licence, terms;
};
// Columns source, repository, licence, terms.
std::vector<Source> parse_sources(const std::string &text, const std::string &name);

} // namespace conceg::characterise
