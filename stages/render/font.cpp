// SPDX-License-Identifier: BSD-3-Clause
#include "font.hpp"

#include <algorithm>
#include <cstdint>
#include <map>

namespace conceg::rendering {
namespace {

// Control points are pairs of digits: x in steps of 0.08 of the capital height, y with the base line at 2,
// small letters up to 7 and capitals up to 9. "~" smooths an open line, "o" a closed one.
struct Glyph {
  int width;
  const char *strokes;
};

// clang-format off
const std::map<std::uint32_t, Glyph> &glyphs() {
  static const std::map<std::uint32_t, Glyph> table = {
      {' ', {4, ""}}, {'A', {8, "024982 1565"}}, {'B', {8, "0209 ~095979765606 ~065686825202"}},
      {'C', {8, "~878909028284"}}, {'D', {8, "0209 ~094989824202"}}, {'E', {7, "79090272 0666"}},
      {'F', {7, "790902 0666"}}, {'G', {8, "~878909028286 8656"}}, {'H', {8, "0209 8289 0686"}},
      {'I', {0, "0209"}}, {'J', {5, "5954 ~54520203"}}, {'K', {8, "0209 8905 2682"}},
      {'L', {7, "090272"}}, {'M', {8, "0209448982"}}, {'N', {8, "02098289"}}, {'O', {8, "o09898202"}},
      {'P', {8, "0209 ~095989855505"}}, {'Q', {8, "o09898202 5481"}}, {'R', {8, "0209 ~095989855505 4582"}},
      {'S', {8, "~8889090685820203"}}, {'T', {8, "0989 4942"}}, {'U', {8, "~090502828589"}},
      {'V', {8, "094289"}}, {'W', {9, "0922486299"}}, {'X', {8, "0982 0289"}}, {'Y', {8, "094589 4542"}},
      {'Z', {8, "09890282"}}, {'a', {6, "o07676202 6762"}}, {'b', {6, "0209 o07676202"}},
      {'c', {6, "~666707026263"}}, {'d', {6, "o07676202 6962"}}, {'e', {6, "0565 ~656707026263"}},
      {'f', {4, "~492926 2622 0747"}}, {'g', {6, "o07676202 6762 ~62600001"}},
      {'h', {6, "0209 ~04076764 6462"}}, {'i', {0, "0207 0909"}}, {'j', {2, "2721 ~212000 2929"}},
      {'k', {6, "0209 6704 2562"}}, {'l', {0, "0902"}}, {'m', {8, "0207 ~04074744 4442 ~44478784 8482"}},
      {'n', {6, "0207 ~04076764 6462"}}, {'o', {6, "o07676202"}}, {'p', {6, "0700 o07676202"}},
      {'q', {6, "o07676202 6760"}}, {'r', {4, "0207 ~040747"}}, {'s', {5, "~5657070554520203"}},
      {'t', {4, "2923 ~232242 0747"}}, {'u', {6, "0704 ~04026265 6762"}}, {'v', {6, "073267"}},
      {'w', {8, "0722466287"}}, {'x', {6, "0762 0267"}}, {'y', {6, "0732 6720"}}, {'z', {6, "07670262"}},
      {'0', {6, "o09696202"}}, {'1', {3, "073932"}}, {'2', {6, "~0709696602 0262"}},
      {'3', {6, "~0809696626 ~2666620203"}}, {'4', {6, "42490464"}}, {'5', {6, "690906 ~0667620203"}},
      {'6', {6, "~590904 o06666202"}}, {'7', {6, "096922"}}, {'8', {6, "o09696606 o06666202"}},
      {'9', {6, "o09696505 ~676312"}}, {'.', {0, "0202"}}, {',', {1, "1200"}}, {':', {0, "0202 0606"}},
      {'/', {6, "0169"}}, {'-', {5, "0555"}}, {'+', {6, "0565 3238"}}, {'=', {6, "0464 0666"}},
      {'(', {2, "~29070421"}}, {')', {2, "~09272401"}}, {'%', {7, "0279 o09292606 o55757252"}},
      {'_', {6, "0161"}}, {0xB5, {6, "0700 ~04026265 6762"}}, {0x3BC, {6, "0700 ~04026265 6762"}},
      {0xD7, {6, "1357 1753"}}, {0xB0, {2, "o09292606"}}};
  return table;
}
// clang-format on

constexpr Glyph unknown = {6, "0969620209"};
constexpr double x_step = 0.08, gap = 0.24, height = 7.0;

const Glyph &glyph(std::uint32_t code) {
  const auto found = glyphs().find(code);
  return found == glyphs().end() ? unknown : found->second;
}

// The next character of UTF-8 text; a broken byte stands for itself.
std::uint32_t next_code(const std::string &text, std::size_t &at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const std::uint32_t first = byte(at++);
  const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : 0;
  std::uint32_t code = more == 3 ? first & 7u : more == 2 ? first & 15u : more == 1 ? first & 31u : first;
  for (int i = 0; i < more && (byte(at) & 0xC0u) == 0x80u; i++)
    code = (code << 6) | (byte(at++) & 63u);
  return code;
}

using Line = std::vector<glm::dvec2>;

// Cuts the corners twice: the line becomes a smooth curve that keeps its ends.
Line smoothed(Line line, bool closed) {
  for (int pass = 0; pass < 3; pass++) {
    Line finer;
    const std::size_t count = line.size();
    if (!closed) finer.push_back(line.front());
    for (std::size_t i = 0; i + (closed ? 0 : 1) < count; i++) {
      const glm::dvec2 &a = line[i], &b = line[(i + 1) % count];
      if (closed || i > 0) finer.push_back(0.75 * a + 0.25 * b);
      if (closed || i + 2 < count) finer.push_back(0.25 * a + 0.75 * b);
    }
    if (!closed) finer.push_back(line.back());
    line = std::move(finer);
  }
  return line;
}

void add_line(const std::string &word, double left, std::vector<Stroke> &out) {
  const bool closed = word[0] == 'o', smooth = closed || word[0] == '~';
  Line line;
  for (std::size_t i = smooth ? 1 : 0; i + 1 < word.size(); i += 2)
    line.emplace_back(left + x_step * (word[i] - '0'), (word[i + 1] - '2') / height);
  if (smooth) line = smoothed(std::move(line), closed);
  if (closed) line.push_back(line.front());
  for (std::size_t i = 0; i + 1 < line.size(); i++)
    out.emplace_back(line[i], line[i + 1]);
}

} // namespace

std::vector<Stroke> text_strokes(const std::string &text) {
  std::vector<Stroke> strokes;
  double left = 0.0;
  for (std::size_t at = 0; at < text.size();) {
    const Glyph &shape = glyph(next_code(text, at));
    const std::string words = shape.strokes;
    for (std::size_t from = 0; from < words.size();) {
      const std::size_t end = std::min(words.find(' ', from), words.size());
      add_line(words.substr(from, end - from), left, strokes);
      from = end + 1;
    }
    left += x_step * shape.width + gap;
  }
  return strokes;
}

double text_advance(const std::string &text) {
  double width = 0.0;
  for (std::size_t at = 0; at < text.size();)
    width += x_step * glyph(next_code(text, at)).width + gap;
  return std::max(0.0, width - gap);
}

} // namespace conceg::rendering
