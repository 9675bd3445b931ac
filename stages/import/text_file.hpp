// SPDX-License-Identifier: BSD-3-Clause
// A text file of another program, read word by word or line by line; every complaint names file and line.
#pragma once

#include "guard.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace conceg::importing {

// Larger coordinates and radii are no tissue: the file is in another unit, or damaged.
inline constexpr double coordinate_limit_um = 1e6;

class TextFile {
public:
  // E_IO when it cannot be read, E_NOMEM when it is larger than the memory that the run may use.
  static TextFile open(conceg_ctx *ctx, const std::string &path);
  TextFile(std::string bytes, std::string path) : bytes_(std::move(bytes)), path_(std::move(path)) {}

  // The next line without its end; false after the last.
  bool line(std::string_view &out);
  // The next word on this line or a later one; false at the end.
  bool word(std::string_view &out);
  bool at_end(); // nothing but white space is left

  // The next word as a finite number, a coordinate in um, a radius above 0 in um, or a count.
  double number(const char *what);
  double coordinate(const char *what);
  double radius(const char *what);
  std::uint64_t count(const char *what);

  // The same of a word at hand.
  double number(std::string_view word, const char *what) const;
  double coordinate(std::string_view word, const char *what) const;
  double radius(std::string_view word, const char *what) const;
  std::uint64_t count(std::string_view word, const char *what) const;

  // E_FORMAT "path:line: ...".
  [[noreturn]] void refuse(const char *format, ...) const CONCEG_PRINTF(2, 3);
  const std::string &path() const { return path_; }
  std::size_t line_number() const { return line_; }

private:
  std::string bytes_, path_;
  std::size_t at_ = 0, line_ = 0;
  bool inside_ = false; // word() is within the line that line_ counts
};

std::vector<std::string_view> words_of(std::string_view line);
// All bytes of a file, at most as many as the run may use memory.
std::string read_bytes(conceg_ctx *ctx, const std::string &path);
bool parse_number(std::string_view word, double &out); // without locale; false unless all of the word is one
std::string shown(std::string_view word);              // fit for a message: short, plain characters only

} // namespace conceg::importing
