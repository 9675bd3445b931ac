// SPDX-License-Identifier: BSD-3-Clause
#include "text_file.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <sys/stat.h>

namespace conceg::importing {
namespace {

bool blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

} // namespace

std::string read_bytes(conceg_ctx *ctx, const std::string &path) {
  std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  struct stat found = {};
  if (!file || fstat(fileno(file.get()), &found) != 0)
    fail(CONCEG_E_IO, "%s: cannot be read: %s", path.c_str(), std::strerror(errno));
  if (S_ISDIR(found.st_mode)) fail(CONCEG_E_IO, "%s: expected a file, got a folder", path.c_str());
  const auto memory = static_cast<double>(conceg_ctx_memory(ctx));
  std::string bytes;
  char block[1 << 16];
  while (const std::size_t got = std::fread(block, 1, sizeof block, file.get())) {
    bytes.append(block, got);
    if (static_cast<double>(bytes.size()) > memory)
      fail(CONCEG_E_NOMEM, "%s: larger than the memory that may be used; raise --memory", path.c_str());
  }
  if (std::ferror(file.get()))
    fail(CONCEG_E_IO, "%s: cannot be read: %s", path.c_str(), std::strerror(errno));
  return bytes;
}

TextFile TextFile::open(conceg_ctx *ctx, const std::string &path) {
  return {read_bytes(ctx, path), path};
}

bool TextFile::line(std::string_view &out) {
  inside_ = false;
  if (at_ >= bytes_.size()) return false;
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  out = std::string_view(bytes_).substr(at_, end - at_);
  if (!out.empty() && out.back() == '\r') out.remove_suffix(1);
  at_ = end + 1;
  line_++;
  return true;
}

bool TextFile::word(std::string_view &out) {
  if (!inside_) line_++, inside_ = true;
  while (at_ < bytes_.size() && (blank(bytes_[at_]) || bytes_[at_] == '\n'))
    line_ += bytes_[at_++] == '\n';
  if (at_ >= bytes_.size()) return false;
  const std::size_t from = at_;
  while (at_ < bytes_.size() && !blank(bytes_[at_]) && bytes_[at_] != '\n')
    at_++;
  out = std::string_view(bytes_).substr(from, at_ - from);
  return true;
}

bool TextFile::at_end() {
  const std::size_t at = at_, line = line_;
  const bool inside = inside_;
  std::string_view rest;
  const bool end = !word(rest);
  if (!end) at_ = at, line_ = line, inside_ = inside;
  return end;
}

double TextFile::number(const char *what) {
  std::string_view text;
  if (!word(text))
    refuse("expected %s, got the end of the file: it is cut off, or a count is too large", what);
  return number(text, what);
}
double TextFile::coordinate(const char *what) {
  std::string_view text;
  if (!word(text))
    refuse("expected %s, got the end of the file: it is cut off, or a count is too large", what);
  return coordinate(text, what);
}
double TextFile::radius(const char *what) {
  std::string_view text;
  if (!word(text))
    refuse("expected %s, got the end of the file: it is cut off, or a count is too large", what);
  return radius(text, what);
}
std::uint64_t TextFile::count(const char *what) {
  std::string_view text;
  if (!word(text))
    refuse("expected %s, got the end of the file: it is cut off, or a count is too large", what);
  return count(text, what);
}

double TextFile::number(std::string_view word, const char *what) const {
  double value = 0.0;
  if (!parse_number(word, value)) refuse("expected %s, got \"%s\"", what, shown(word).c_str());
  if (!std::isfinite(value)) refuse("%s: expected a finite number, got %s", what, shown(word).c_str());
  return value;
}
double TextFile::coordinate(std::string_view word, const char *what) const {
  const double value = number(word, what);
  if (!(std::fabs(value) <= coordinate_limit_um))
    refuse("%s: expected at most %g um, got %g: is the file in um?", what, coordinate_limit_um, value);
  return value;
}
double TextFile::radius(std::string_view word, const char *what) const {
  const double value = coordinate(word, what);
  if (!(static_cast<float>(value) > 0.0f)) refuse("%s: expected a radius above 0, got %g", what, value);
  return value;
}
std::uint64_t TextFile::count(std::string_view word, const char *what) const {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    refuse("expected %s, a whole number, got \"%s\"", what, shown(word).c_str());
  return value;
}

void TextFile::refuse(const char *format, ...) const {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  fail(CONCEG_E_FORMAT, "%s:%zu: %s", path_.c_str(), std::max<std::size_t>(1, line_), text);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size();) {
    while (at < line.size() && blank(line[at]))
      at++;
    std::size_t end = at;
    while (end < line.size() && !blank(line[end]))
      end++;
    if (end > at) words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

bool parse_number(std::string_view word, double &out) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  return error == std::errc() && end == word.data() + word.size() && !word.empty();
}

std::string shown(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, 40))
    text += c >= ' ' && c < 0x7f ? c : '?';
  return word.size() > 40 ? text + "..." : text;
}

} // namespace conceg::importing
