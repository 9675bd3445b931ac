// SPDX-License-Identifier: BSD-3-Clause
// JSON text that may stand inside a <script> of an HTML page: no '<' ever leaves it, so that neither
// "</script>" nor "<!--" in a name of the document can end the element.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace conceg::reporting {

class Json {
public:
  Json &open(char bracket) { return before(), out_ += bracket, fresh_ = true, *this; }
  Json &close(char bracket) { return out_ += bracket, fresh_ = false, *this; }
  Json &key(std::string_view name) { return text(name), out_ += ':', fresh_ = true, *this; }

  Json &text(std::string_view value) {
    before(), out_ += '"';
    for (const char c : value) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == '"' || c == '\\')
        out_ += '\\', out_ += c;
      else if (byte < 0x20 || c == '<' || c == '>' || c == '&' || byte == 0x7f) {
        char escape[8];
        std::snprintf(escape, sizeof escape, "\\u%04x", byte);
        out_ += escape;
      } else
        out_ += c;
    }
    return out_ += '"', *this;
  }
  // The shortest text that reads back as the same number; null for what is not finite.
  Json &number(double value) {
    if (!std::isfinite(value)) return null();
    char digits[40];
    const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    return raw({digits, static_cast<std::size_t>(end - digits)});
  }
  Json &number(float value) {
    if (!std::isfinite(value)) return null();
    char digits[40];
    const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    return raw({digits, static_cast<std::size_t>(end - digits)});
  }
  // Past 2^53 as text, which a reader of doubles shows without rounding it.
  Json &whole(std::uint64_t value) {
    const std::string digits = std::to_string(value);
    return value > exact ? text(digits) : raw(digits);
  }
  Json &whole(std::int64_t value) {
    const std::string digits = std::to_string(value);
    return value > static_cast<std::int64_t>(exact) || value < -static_cast<std::int64_t>(exact)
               ? text(digits)
               : raw(digits);
  }
  Json &flag(bool value) { return raw(value ? "true" : "false"); }
  Json &null() { return raw("null"); }

  const std::string &str() const { return out_; }

private:
  static constexpr std::uint64_t exact = std::uint64_t{1} << 53;
  Json &raw(std::string_view value) { return before(), out_ += value, *this; }
  void before() {
    if (!fresh_) out_ += ',';
    fresh_ = false;
  }
  std::string out_;
  bool fresh_ = true;
};

} // namespace conceg::reporting
