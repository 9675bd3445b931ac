// SPDX-License-Identifier: BSD-3-Clause
// The ZIP around NumPy's arrays: its list of files at the end, then the one that is asked for. Every size and
// place is checked against the file before it is used.
#include "npy.hpp"

#include "text_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace conceg::importing {
namespace {

constexpr std::uint32_t end_signature = 0x06054b50, end64_signature = 0x06064b50,
                        locator_signature = 0x07064b50, entry_signature = 0x02014b50,
                        local_signature = 0x04034b50;
constexpr std::size_t end_bytes = 22, end64_bytes = 56, locator_bytes = 20, entry_bytes = 46,
                      local_bytes = 30;
constexpr std::uint32_t in_zip64 = 0xffffffff;
constexpr unsigned stored = 0, deflated = 8;

struct Entry {
  std::string name;
  unsigned method, flags;
  std::uint32_t crc;
  std::uint64_t packed, size, offset;
};

class Zip {
public:
  Zip(const std::string &bytes, const std::string &path) : bytes_(bytes), path_(path) {}

  std::vector<Entry> entries() const {
    const std::size_t end = find_end();
    std::uint64_t count = number(end + 10, 2), at = number(end + 16, 4);
    if (end >= locator_bytes && number(end - locator_bytes, 4) == locator_signature) {
      const std::uint64_t far = number(end - locator_bytes + 8, 8);
      need(far, end64_bytes, "the list of files");
      if (number(far, 4) != end64_signature) refuse("the list of files");
      count = number(far + 32, 8), at = number(far + 48, 8);
    }
    std::vector<Entry> out;
    for (std::uint64_t i = 0; i < count; i++) {
      need(at, entry_bytes, "the list of files");
      if (number(at, 4) != entry_signature) refuse("the list of files");
      const std::uint64_t name = number(at + 28, 2), extra = number(at + 30, 2), note = number(at + 32, 2);
      need(at + entry_bytes, name + extra + note, "the list of files");
      Entry e = {bytes_.substr(at + entry_bytes, name),
                 static_cast<unsigned>(number(at + 10, 2)),
                 static_cast<unsigned>(number(at + 8, 2)),
                 static_cast<std::uint32_t>(number(at + 16, 4)),
                 number(at + 20, 4),
                 number(at + 24, 4),
                 number(at + 42, 4)};
      widen(e, at + entry_bytes + name, extra);
      out.push_back(std::move(e));
      at += entry_bytes + name + extra + note;
    }
    return out;
  }

  std::string unpack(const Entry &e, double most_bytes) const {
    const char *name = e.name.c_str();
    if (e.flags & 1) fail(CONCEG_E_FORMAT, "%s: %s is encrypted", path_.c_str(), shown(name).c_str());
    if (e.method != stored && e.method != deflated)
      fail(CONCEG_E_FORMAT, "%s: %s: expected stored or deflated bytes, got method %u", path_.c_str(),
           shown(name).c_str(), e.method);
    if (static_cast<double>(e.size) > most_bytes)
      fail(CONCEG_E_NOMEM, "%s: %s: %.3g bytes are more than may be used; raise --memory", path_.c_str(),
           shown(name).c_str(), static_cast<double>(e.size));
    need(e.offset, local_bytes, name);
    if (number(e.offset, 4) != local_signature) refuse(name);
    const std::uint64_t from = e.offset + local_bytes + number(e.offset + 26, 2) + number(e.offset + 28, 2);
    need(from, e.packed, name);
    std::string out = e.method == stored ? bytes_.substr(from, e.packed) : inflated(e, from);
    if (out.size() != e.size || crc_of(out) != e.crc) refuse(name);
    return out;
  }

private:
  [[noreturn]] void refuse(const char *what) const {
    fail(CONCEG_E_FORMAT, "%s: %s: the ZIP is cut off or damaged", path_.c_str(), shown(what).c_str());
  }
  void need(std::uint64_t at, std::uint64_t count, const char *what) const {
    if (at > bytes_.size() || count > bytes_.size() - at) refuse(what);
  }
  // Little-endian, at a place that was checked.
  std::uint64_t number(std::uint64_t at, int bytes) const {
    std::uint64_t value = 0;
    for (int k = bytes; k-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes_[at + static_cast<std::uint64_t>(k)]);
    return value;
  }
  // The last record of the file, behind which there may be a note of up to 64 KiB.
  std::size_t find_end() const {
    if (bytes_.size() < end_bytes) refuse("the list of files");
    const std::size_t last = bytes_.size() - end_bytes, first = last - std::min<std::size_t>(last, 0xffff);
    for (std::size_t at = last + 1; at-- > first;)
      if (number(at, 4) == end_signature) return at;
    refuse("the list of files");
  }
  // Sizes of 8 bytes, in the extra field of number 1.
  void widen(Entry &e, std::uint64_t at, std::uint64_t count) const {
    const std::uint64_t end = at + count;
    while (at + 4 <= end) {
      const std::uint64_t id = number(at, 2), size = number(at + 2, 2), field_end = at + 4 + size;
      if (field_end > end) refuse(e.name.c_str());
      at += 4;
      for (std::uint64_t *value : {&e.size, &e.packed, &e.offset}) {
        if (id != 1 || *value != in_zip64) continue;
        if (at + 8 > field_end) refuse(e.name.c_str());
        *value = number(at, 8), at += 8;
      }
      at = field_end;
    }
  }
  static std::uint32_t crc_of(const std::string &bytes) {
    return static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef *>(bytes.data()), bytes.size()));
  }
  std::string inflated(const Entry &e, std::uint64_t from) const {
    constexpr std::uint64_t at_once = 1u << 30; // zlib counts in 32 bits
    std::string out;
    z_stream stream = {};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) fail(CONCEG_E_NOMEM, "%s: zlib", path_.c_str());
    std::uint64_t taken = 0;
    int state = Z_OK;
    try {
      while (state == Z_OK && out.size() <= e.size) {
        if (!stream.avail_in && taken < e.packed) {
          stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(bytes_.data() + from + taken));
          stream.avail_in = static_cast<uInt>(std::min(at_once, e.packed - taken));
          taken += stream.avail_in;
        }
        // In steps, so that a size that lies takes no memory; one byte too many ends it.
        const std::uint64_t room = std::min<std::uint64_t>(1u << 24, e.size - out.size() + 1);
        const std::size_t before = out.size();
        out.resize(before + room);
        stream.next_out = reinterpret_cast<Bytef *>(&out[before]), stream.avail_out = static_cast<uInt>(room);
        state = inflate(&stream, Z_NO_FLUSH);
        out.resize(before + room - stream.avail_out);
      }
    } catch (...) {
      inflateEnd(&stream);
      throw;
    }
    inflateEnd(&stream);
    if (state != Z_STREAM_END) refuse(e.name.c_str());
    return out;
  }

  const std::string &bytes_, &path_;
};

} // namespace

NpyArray parse_npz(const std::string &bytes, const std::string &path, const std::string &name,
                   double most_bytes) {
  const Zip zip(bytes, path);
  const std::vector<Entry> entries = zip.entries();
  std::string wanted = (name.empty() ? "labels" : name) + ".npy", there;
  if (name.empty() && entries.size() == 1) wanted = entries[0].name;
  for (const Entry &e : entries) {
    if (e.name == wanted) return parse_npy(zip.unpack(e, most_bytes), path + ": " + shown(e.name));
    if (there.size() < 200) there += (there.empty() ? "" : ", ") + shown(e.name);
  }
  fail(CONCEG_E_MISSING, "%s: no array %s; there are: %s; name one with import.array", path.c_str(),
       shown(wanted).c_str(), there.c_str());
}

} // namespace conceg::importing
