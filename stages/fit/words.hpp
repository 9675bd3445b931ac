// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace conceg::fit {

// The words of a list with commas, without blanks around them; empty ones are left out.
inline std::vector<std::string> split(const std::string &list) {
  std::vector<std::string> out;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) {
    const std::size_t first = word.find_first_not_of(' '), last = word.find_last_not_of(' ');
    if (first != std::string::npos) out.push_back(word.substr(first, last - first + 1));
  }
  return out;
}

} // namespace conceg::fit
