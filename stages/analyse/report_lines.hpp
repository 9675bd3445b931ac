// SPDX-License-Identifier: BSD-3-Clause
// Aligned lines for people: a name, a number of cells, fields.
#pragma once

#include "formatted.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace conceg::analyse {

inline void pad(std::string &line, const std::string &field, std::size_t width) {
  line += std::string(field.size() < width ? width - field.size() : 1, ' ') + field;
}

inline std::string line_of(const std::string &name, const std::string &cells,
                           const std::vector<std::string> &fields, std::size_t width = 16) {
  constexpr std::size_t name_width = 24, cells_width = 7;
  std::string line = name;
  line.resize(std::max(line.size(), name_width), ' ');
  pad(line, cells, cells_width);
  for (const std::string &field : fields)
    pad(line, field, width);
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

} // namespace conceg::analyse
