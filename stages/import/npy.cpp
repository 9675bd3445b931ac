// SPDX-License-Identifier: BSD-3-Clause
#include "npy.hpp"

#include "text_file.hpp"

#include <cstring>
#include <string_view>
#include <vector>

namespace conceg::importing {
namespace {

constexpr char magic[] = "\x93NUMPY";
constexpr std::size_t magic_bytes = 6;
constexpr std::uint64_t most_along_an_axis = std::uint64_t(1) << 30;

// What the header's dictionary says.
struct Header {
  std::string descr;
  bool fortran_order = false, has_descr = false, has_order = false, has_shape = false;
  std::vector<std::uint64_t> shape;
};

// Reads the one Python literal that NumPy writes: a dictionary of a text, a truth value and a tuple of whole
// numbers.
class HeaderReader {
public:
  HeaderReader(std::string_view text, const std::string &where) : text_(text), where_(where) {}

  Header read() {
    Header header;
    expect('{');
    while (!take('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr")
        header.descr = descr(), header.has_descr = true;
      else if (key == "fortran_order")
        header.fortran_order = truth(), header.has_order = true;
      else if (key == "shape")
        header.shape = tuple(), header.has_shape = true;
      else
        refuse("unknown key");
      if (!take(',') && peek() != '}') refuse("expected , or }");
    }
    if (peek()) refuse("expected the end of the header");
    if (!header.has_descr || !header.has_order || !header.has_shape)
      refuse("expected descr, fortran_order and shape");
    return header;
  }

private:
  [[noreturn]] void refuse(const char *what) const {
    fail(CONCEG_E_FORMAT, "%s: header, byte %zu: %s, got \"%s\"", where_.c_str(), at_, what,
         shown(text_.substr(std::min(at_, text_.size()))).c_str());
  }
  char peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n'))
      at_++;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    at_++;
    return true;
  }
  void expect(char c) {
    const char what[] = {'e', 'x', 'p', 'e', 'c', 't', 'e', 'd', ' ', c, '\0'};
    if (!take(c)) refuse(what);
  }
  std::string quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') refuse("expected a text in quotes");
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) refuse("expected the end of a text");
    const std::string out(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return out;
  }
  std::string descr() {
    if (peek() == '[') refuse("expected one whole number per value, not a record");
    return quoted();
  }
  bool truth() {
    peek();
    for (const std::string_view word : {"True", "False"})
      if (text_.substr(at_, word.size()) == word) {
        at_ += word.size();
        return word == "True";
      }
    refuse("expected True or False");
  }
  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> out;
    expect('(');
    while (!take(')')) {
      if (peek() < '0' || peek() > '9') refuse("expected a whole number");
      std::uint64_t value = 0;
      for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; at_++) {
        value = 10 * value + static_cast<std::uint64_t>(text_[at_] - '0');
        if (value > most_along_an_axis) refuse("expected at most 2^30 values along an axis");
      }
      take('L'); // of Python 2
      out.push_back(value);
      if (!take(',') && peek() != ')') refuse("expected , or )");
    }
    return out;
  }

  std::string_view text_;
  const std::string &where_;
  std::size_t at_ = 0;
};

// "<u2" and the like.
void set_type(const std::string &descr, NpyArray &array) {
  const std::string_view kinds = "uib", orders = "<>|=", widths = "1248";
  if (descr.size() != 3 || orders.find(descr[0]) == std::string_view::npos ||
      kinds.find(descr[1]) == std::string_view::npos || widths.find(descr[2]) == std::string_view::npos)
    fail(CONCEG_E_FORMAT,
         "%s: expected whole numbers (u1, u2, u4, u8, i1, i2, i4, i8), got values of type \"%s\"; convert "
         "them with labels.astype(\"u4\")",
         array.where.c_str(), shown(descr).c_str());
  array.width = static_cast<std::uint32_t>(descr[2] - '0');
  array.is_signed = descr[1] == 'i', array.big_endian = descr[0] == '>';
}

} // namespace

std::uint64_t NpyArray::at(std::uint64_t x, std::uint64_t y, std::uint64_t z) const {
  const std::uint64_t index = x * stride[0] + y * stride[1] + z * stride[2];
  const auto *from = reinterpret_cast<const unsigned char *>(bytes.data()) + index * width;
  std::uint64_t value = 0;
  for (std::uint32_t k = 0; k < width; k++)
    value |= static_cast<std::uint64_t>(from[big_endian ? width - 1 - k : k]) << (8 * k);
  if (is_signed && value >> (8 * width - 1))
    fail(CONCEG_E_FORMAT, "%s: [%llu, %llu, %llu]: expected labels from 0 on, got a negative number",
         where.c_str(), static_cast<unsigned long long>(x), static_cast<unsigned long long>(y),
         static_cast<unsigned long long>(z));
  return value;
}

NpyArray parse_npy(std::string bytes, const std::string &where) {
  if (bytes.size() < magic_bytes + 4 || std::memcmp(bytes.data(), magic, magic_bytes) != 0)
    fail(CONCEG_E_FORMAT, "%s: expected a file of NumPy, .npy or .npz; it is none, or cut off",
         where.c_str());
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
  };
  const std::size_t version = byte(magic_bytes), field = version == 1 ? 2 : 4,
                    begin = magic_bytes + 2 + field;
  if (version < 1 || version > 3)
    fail(CONCEG_E_FORMAT, "%s: expected format 1, 2 or 3 of .npy, got %zu", where.c_str(), version);
  std::size_t length = 0;
  for (std::size_t k = 0; k < field && begin <= bytes.size(); k++)
    length |= byte(magic_bytes + 2 + k) << (8 * k);
  if (begin > bytes.size() || length > bytes.size() - begin)
    fail(CONCEG_E_FORMAT, "%s: expected a header of %zu bytes, got the end of the file: it is cut off",
         where.c_str(), length);
  const Header header = HeaderReader(std::string_view(bytes).substr(begin, length), where).read();
  NpyArray array = {};
  array.where = where;
  set_type(header.descr, array);
  const std::size_t axes = header.shape.size();
  if (axes < 2 || axes > 3)
    fail(CONCEG_E_FORMAT, "%s: expected labels on two or three axes, got %zu", where.c_str(), axes);
  std::uint64_t count = 1;
  array.shape = {1, 1, 1};
  for (std::size_t a = 0; a < axes; a++) {
    array.shape[a] = header.shape[a];
    if (!header.shape[a]) fail(CONCEG_E_FORMAT, "%s: axis %zu has no voxels", where.c_str(), a);
    if (count > (std::uint64_t(1) << 60) / header.shape[a])
      fail(CONCEG_E_FORMAT, "%s: expected fewer than 2^60 voxels", where.c_str());
    count *= header.shape[a];
  }
  const std::uint64_t expected = count * array.width, got = bytes.size() - begin - length;
  if (got != expected)
    fail(CONCEG_E_FORMAT, "%s: expected %llu bytes of values as the shape says, got %llu: it is %s",
         where.c_str(), static_cast<unsigned long long>(expected), static_cast<unsigned long long>(got),
         got < expected ? "cut off" : "longer than that");
  const auto &n = array.shape;
  array.stride = header.fortran_order ? std::array<std::uint64_t, 3>{1, n[0], n[0] * n[1]}
                                      : std::array<std::uint64_t, 3>{n[1] * n[2], n[2], 1};
  bytes.erase(0, begin + length);
  array.bytes = std::move(bytes);
  return array;
}

NpyArray parse_numpy(std::string bytes, const std::string &path, const std::string &name, double most_bytes) {
  if (bytes.compare(0, 2, "PK") == 0) return parse_npz(bytes, path, name, most_bytes);
  return parse_npy(std::move(bytes), path);
}

} // namespace conceg::importing
