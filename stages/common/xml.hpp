// SPDX-License-Identifier: BSD-3-Clause
// Text inside XML files that are written by hand.
#pragma once

#include <string>

namespace conceg {

// As content or in a "quoted" attribute.
inline std::string escaped_xml(const std::string &text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c; // XML has no control characters
  }
  return out;
}

} // namespace conceg
