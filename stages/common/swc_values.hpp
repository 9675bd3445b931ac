// SPDX-License-Identifier: BSD-3-Clause
// Arrays as lines of text in SWC-plus (spec/swc-plus.md): quoted texts, whole numbers in decimal, others in
// hexadecimal.
#pragma once

#include "view.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace conceg::swcdoc {

constexpr std::size_t values_per_line = 16, text_per_line = 200;

// ---- Text ----

inline std::string quoted(const std::string &text) {
  std::string out = "\"";
  char code[8];
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += '\\', out += c;
    else if (byte >= 0x20 && byte < 0x7f)
      out += c;
    else { // bytes, not characters: the text comes back as it was
      std::snprintf(code, sizeof code, "\\x%02x", byte);
      out += code;
    }
  }
  return out + "\"";
}

// Reads a quoted text; false when it is not one.
inline bool unquote(const std::string &text, std::string &out) {
  if (text.size() < 2 || text.front() != '"' || text.back() != '"') return false;
  for (std::size_t i = 1; i + 1 < text.size(); i++) {
    if (text[i] != '\\') {
      out += text[i];
      continue;
    }
    if (++i + 1 >= text.size()) return false;
    if (text[i] == '"' || text[i] == '\\') {
      out += text[i];
      continue;
    }
    unsigned byte = 0;
    if (text[i] != 'x' || i + 3 >= text.size() ||
        std::from_chars(&text[i + 1], &text[i + 3], byte, 16).ptr != &text[i + 3] || !byte)
      return false;
    out += static_cast<char>(byte), i += 2;
  }
  return true;
}

inline void put_texts(std::vector<std::string> &lines, const char *const *strings, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; i++) {
    const std::string text = strings[i];
    lines.push_back("@text " + quoted(text.substr(0, text_per_line)));
    for (std::size_t at = text_per_line; at < text.size(); at += text_per_line)
      lines.push_back("@more " + quoted(text.substr(at, text_per_line)));
  }
}

// ---- Numbers: whole ones in decimal, others in hexadecimal, so that nothing is rounded ----

template <class T> void put_number(std::string &line, T value) {
  char digits[64];
  if constexpr (std::is_floating_point_v<T>) {
    const double wide = value;
    if (std::isfinite(wide)) {
      line += std::signbit(wide) ? " -0x" : " 0x";
      line.append(digits,
                  std::to_chars(digits, digits + sizeof digits, std::fabs(wide), std::chars_format::hex).ptr);
    } else
      line += std::isnan(wide) ? " nan" : wide < 0 ? " -inf" : " inf";
  } else {
    line += ' ';
    line.append(digits, std::to_chars(digits, digits + sizeof digits, static_cast<long long>(0) + value).ptr);
  }
}
template <> inline void put_number(std::string &line, std::uint64_t value) {
  line += ' ' + std::to_string(value);
}

template <class T> void put_numbers(std::vector<std::string> &lines, const void *data, std::uint64_t count) {
  const T *values = static_cast<const T *>(data);
  for (std::uint64_t first = 0; first < count; first += values_per_line) {
    std::string line = "@values";
    for (std::uint64_t i = first; i < std::min<std::uint64_t>(count, first + values_per_line); i++)
      put_number(line, values[i]);
    lines.push_back(std::move(line));
  }
}

template <class T> const char *read_number(const char *p, const char *end, T &out) {
  if constexpr (std::is_floating_point_v<T>) {
    const bool minus = p < end && *p == '-';
    if (minus) p++;
    double value = 0.0;
    std::from_chars_result read;
    if (end - p > 2 && p[0] == '0' && p[1] == 'x')
      read = std::from_chars(p + 2, end, value, std::chars_format::hex);
    else
      read = std::from_chars(p, end, value);
    if (read.ec != std::errc()) return nullptr;
    out = static_cast<T>(minus ? -value : value);
    return read.ptr;
  } else {
    const std::from_chars_result read = std::from_chars(p, end, out);
    return read.ec == std::errc() ? read.ptr : nullptr;
  }
}

template <class T> bool read_numbers(const char *p, std::vector<unsigned char> &bytes) {
  const char *const end = p + std::strlen(p);
  for (;;) {
    while (p < end && *p == ' ')
      p++;
    if (p == end) return true;
    T value;
    p = read_number(p, end, value);
    if (!p || (p < end && *p != ' ')) return false;
    const auto *raw = reinterpret_cast<const unsigned char *>(&value);
    bytes.insert(bytes.end(), raw, raw + sizeof value);
  }
}

// Calls body with a value of the C++ type of a dtype.
template <class Body> void with_type(conceg_dtype dtype, Body &&body) {
  switch (dtype) {
  case CONCEG_U8:
    return body(std::uint8_t{});
  case CONCEG_I8:
    return body(std::int8_t{});
  case CONCEG_U32:
    return body(std::uint32_t{});
  case CONCEG_I32:
    return body(std::int32_t{});
  case CONCEG_U64:
    return body(std::uint64_t{});
  case CONCEG_I64:
    return body(std::int64_t{});
  case CONCEG_F32:
    return body(float{});
  default:
    return body(double{});
  }
}

inline conceg_dtype dtype_named(const std::string &name) {
  for (int dtype = CONCEG_U8; dtype <= CONCEG_TEXT; dtype++)
    if (name == conceg_dtype_name(static_cast<conceg_dtype>(dtype))) return static_cast<conceg_dtype>(dtype);
  return CONCEG_DTYPE_MAXIMUM;
}

} // namespace conceg::swcdoc
