// SPDX-License-Identifier: BSD-3-Clause
// The output folder and the list of what was written into it.
#pragma once

#include "output.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace conceg::exporting {

// What one written file holds.
struct Written {
  std::string file;       // relative to the folder, with "/"
  std::string what;       // "skeleton", "surface", "surfaces", "volume"
  std::int64_t cell = -1; // row of the cell, -1 = all
  std::uint64_t id = 0;
  std::string type, layer;
  std::uint64_t points = 0, faces = 0;
};

// The output folder; made with its parents when absent.
class OutputFolder {
public:
  explicit OutputFolder(const std::string &path);
  // Full path of a file in the folder, whose sub-folder is made.
  std::string at(const std::string &file);
  void add(Written written) { written_.push_back(std::move(written)); }
  const std::vector<Written> &written() const { return written_; }
  void write_index(); // index.csv

private:
  std::string path_;
  std::set<std::string> made_;
  std::vector<Written> written_;
};

std::string quoted_csv(const std::string &text);
std::string quoted_json(const std::string &text); // plain ASCII, other characters as \u codes
// "cell_0007_L23_pyramidal" for row 7 of type "L2/3 pyramidal": letters, digits and single underscores only.
std::string cell_file_name(std::uint64_t cell, const std::string &type);

} // namespace conceg::exporting
