// SPDX-License-Identifier: BSD-3-Clause
#include "ply.hpp"

#include <cstring>

namespace conceg::exporting {
namespace {

// Collects small pieces so that the file sees large writes.
class Buffer {
public:
  explicit Buffer(OutputFile &file) : file_(file) { bytes_.reserve(limit + 256); }
  void put(const void *data, std::size_t count) {
    bytes_.append(static_cast<const char *>(data), count);
    if (bytes_.size() >= limit) flush();
  }
  void flush() {
    file_.write(bytes_);
    bytes_.clear();
  }

private:
  static constexpr std::size_t limit = 1 << 20;
  OutputFile &file_;
  std::string bytes_;
};

// Readers that split the header into words stop at these, so they are broken by a hyphen.
std::string harmless(const std::string &comment) {
  std::string out, word;
  const auto flush = [&] {
    for (const char *keyword : {"vertex", "face", "nx", "end_header", "element"})
      if (word == keyword) word.insert(1, "-");
    out += word;
    word.clear();
  };
  for (const char c : comment) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') {
      flush();
      out += ' ';
    } else {
      word += c;
    }
  }
  flush();
  return out;
}

void little_endian(std::uint32_t value, unsigned char out[4]) {
  for (int i = 0; i < 4; i++)
    out[i] = static_cast<unsigned char>(value >> (8 * i));
}
void little_endian(double value, unsigned char out[8]) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  for (int i = 0; i < 8; i++)
    out[i] = static_cast<unsigned char>(bits >> (8 * i));
}

// The shortest of 9 to 17 digits that reads back as the same double.
int print_double(char *out, std::size_t size, double value) {
  for (int digits = 9;; digits += 4) {
    const int length = std::snprintf(out, size, "%.*g", digits, value);
    if (digits >= 17 || std::strtod(out, nullptr) == value) return length;
  }
}

void put_vertex(Buffer &buffer, const glm::dvec3 &position, bool ascii) {
  if (ascii) {
    char line[128];
    int length = 0;
    for (int axis = 0; axis < 3; axis++) {
      length +=
          print_double(line + length, sizeof line - static_cast<std::size_t>(length) - 1, position[axis]);
      line[length++] = axis == 2 ? '\n' : ' ';
    }
    buffer.put(line, static_cast<std::size_t>(length));
  } else {
    unsigned char bytes[24];
    for (int axis = 0; axis < 3; axis++)
      little_endian(position[axis], bytes + 8 * axis);
    buffer.put(bytes, sizeof bytes);
  }
}

void put_face(Buffer &buffer, const glm::uvec3 &face, std::uint32_t base, bool ascii) {
  if (ascii) {
    char line[64];
    const int length =
        std::snprintf(line, sizeof line, "3 %u %u %u\n", face.x + base, face.y + base, face.z + base);
    buffer.put(line, static_cast<std::size_t>(length));
  } else {
    unsigned char bytes[13];
    bytes[0] = 3;
    for (int k = 0; k < 3; k++)
      little_endian(face[k] + base, bytes + 1 + 4 * k);
    buffer.put(bytes, sizeof bytes);
  }
}

} // namespace

void write_ply(OutputFile &file, const std::vector<const Surface *> &surfaces, bool ascii,
               const std::vector<std::string> &comments) {
  std::uint64_t vertices = 0, faces = 0;
  for (const Surface *surface : surfaces)
    vertices += surface->vertex.size(), faces += surface->face.size();
  if (vertices > 0x7fffffffu)
    fail(CONCEG_E_UNSUPPORTED, "a PLY file numbers at most 2147483647 points, got %llu; export single cells",
         static_cast<unsigned long long>(vertices));
  std::string header = std::string("ply\nformat ") + (ascii ? "ascii" : "binary_little_endian") + " 1.0\n";
  for (const std::string &comment : comments)
    header += "comment " + harmless(comment) + "\n";
  header += "element vertex " + std::to_string(vertices) +
            "\nproperty double x\nproperty double y\nproperty double z\n";
  header +=
      "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
  file.write(header);
  Buffer buffer(file);
  for (const Surface *surface : surfaces)
    for (const glm::dvec3 &position : surface->vertex)
      put_vertex(buffer, position, ascii);
  std::uint32_t base = 0;
  for (const Surface *surface : surfaces) {
    for (const glm::uvec3 &face : surface->face)
      put_face(buffer, face, base, ascii);
    base += static_cast<std::uint32_t>(surface->vertex.size());
  }
  buffer.flush();
}

} // namespace conceg::exporting
