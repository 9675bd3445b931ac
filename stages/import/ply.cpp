// SPDX-License-Identifier: BSD-3-Clause
// PLY surfaces: text, binary of either byte order, triangles or polygons (cut into fans). Every property but
// x, y, z and the list of corners is passed over. Sizes are compared with the bytes that are there before
// anything is allocated.
#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace conceg::importing {
namespace {

constexpr std::uint64_t most_corners = 1000;

struct Property {
  std::string name;
  std::size_t bytes = 0, count_bytes = 0; // count_bytes > 0: a list
  bool floating = false, sign = false, count_sign = false;
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
public:
  PlyReader(const std::string &bytes, const std::string &path)
      : header_(bytes.substr(0, header_end(bytes, path)), path), bytes_(bytes), path_(path) {}

  Surface run() {
    read_header();
    at_ = header_end(bytes_, path_);
    line_ = 1 + static_cast<std::size_t>(
                    std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n'));
    for (const Element &element : elements_)
      read_element(element);
    if (text_ && next_word(nullptr)) refuse("expected the end of the file: a count is too small");
    if (!text_ && at_ != bytes_.size()) refuse("expected the end of the file: a count is too small");
    return std::move(surface_);
  }

private:
  static std::size_t header_end(const std::string &bytes, const std::string &path) {
    if (bytes.compare(0, 3, "ply") != 0)
      fail(CONCEG_E_FORMAT, "%s:1: expected a PLY file, whose first line is \"ply\"", path.c_str());
    const std::size_t word = bytes.find("\nend_header"),
                      end = word == std::string::npos ? word : bytes.find('\n', word + 1);
    if (end == std::string::npos)
      fail(CONCEG_E_FORMAT, "%s:%td: expected a line end_header", path.c_str(),
           1 + std::count(bytes.begin(), bytes.end(), '\n'));
    return end + 1;
  }

  static void set_type(std::string_view name, const TextFile &text, std::size_t &bytes, bool &floating,
                       bool &sign) {
    static const std::map<std::string_view, std::pair<std::size_t, char>> types = {
        {"char", {1, 's'}},  {"int8", {1, 's'}},    {"uchar", {1, 'u'}},  {"uint8", {1, 'u'}},
        {"short", {2, 's'}}, {"int16", {2, 's'}},   {"ushort", {2, 'u'}}, {"uint16", {2, 'u'}},
        {"int", {4, 's'}},   {"int32", {4, 's'}},   {"uint", {4, 'u'}},   {"uint32", {4, 'u'}},
        {"float", {4, 'f'}}, {"float32", {4, 'f'}}, {"double", {8, 'f'}}, {"float64", {8, 'f'}}};
    const auto found = types.find(name);
    if (found == types.end()) text.refuse("unknown type of a property: %s", shown(name).c_str());
    bytes = found->second.first, floating = found->second.second == 'f', sign = found->second.second == 's';
  }

  void read_header() {
    std::string_view line;
    bool form = false;
    while (header_.line(line)) {
      const auto words = words_of(line);
      if (words.empty() || words[0] == "ply" || words[0] == "comment" || words[0] == "obj_info" ||
          words[0] == "end_header")
        continue;
      if (words[0] == "format" && words.size() == 3) {
        form = true, text_ = words[1] == "ascii", big_ = words[1] == "binary_big_endian";
        if (!text_ && !big_ && words[1] != "binary_little_endian")
          header_.refuse("unknown format %s", shown(words[1]).c_str());
      } else if (words[0] == "element" && words.size() == 3) {
        elements_.push_back({std::string(words[1]), header_.count(words[2], "the number of elements"), {}});
      } else if (words[0] == "property" &&
                 words.size() == (words.size() > 1 && words[1] == "list" ? 5u : 3u) && !elements_.empty()) {
        Property property;
        bool ignored = false;
        property.name = std::string(words.back());
        if (words.size() == 5)
          set_type(words[2], header_, property.count_bytes, ignored, property.count_sign);
        if (words.size() == 5 && ignored) header_.refuse("expected whole numbers as lengths of a list");
        set_type(words[words.size() - 2], header_, property.bytes, property.floating, property.sign);
        elements_.back().properties.push_back(property);
      } else {
        header_.refuse("unknown header line \"%s\"", shown(line).c_str());
      }
    }
    if (!form) header_.refuse("expected a line \"format\"");
  }

  void read_element(const Element &element) {
    std::size_t least = 0; // bytes of a row, at least
    for (const Property &p : element.properties)
      least += text_ ? 2 : p.count_bytes ? p.count_bytes : p.bytes;
    if (element.properties.empty() && element.count)
      refuse("element %s without properties", shown(element.name).c_str());
    if (static_cast<double>(element.count) * static_cast<double>(least) >
        static_cast<double>(bytes_.size() - at_) + 1.0)
      refuse("%llu of %s cannot fit into the file: it is cut off, or the count is wrong",
             static_cast<unsigned long long>(element.count), shown(element.name).c_str());
    const bool vertex = element.name == "vertex", face = element.name == "face";
    if (face && element.count &&
        std::none_of(element.properties.begin(), element.properties.end(), is_corner_list))
      refuse("expected a list vertex_indices of each face");
    for (std::uint64_t row = 0; row < element.count; row++) {
      glm::dvec3 at(NAN);
      for (const Property &p : element.properties) {
        if (!p.count_bytes) {
          const double value = next_value(p.bytes, p.floating, p.sign);
          if (vertex && p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z')
            at[p.name[0] - 'x'] = value;
          continue;
        }
        const double length = next_value(p.count_bytes, false, p.count_sign);
        if (!(length >= 0.0 && length <= static_cast<double>(most_corners)))
          refuse("expected a list of 0 to %llu values, got %g", static_cast<unsigned long long>(most_corners),
                 length);
        corner_.clear();
        for (double i = 0.0; i < length; i++)
          corner_.push_back(next_value(p.bytes, p.floating, p.sign));
        if (face && is_corner_list(p)) add_face();
      }
      if (!vertex) continue;
      for (int axis = 0; axis < 3; axis++)
        if (!(std::fabs(at[axis]) <= coordinate_limit_um))
          refuse("expected x y z, finite and at most %g um, got %g %g %g", coordinate_limit_um, at.x, at.y,
                 at.z);
      surface_.vertex.push_back(at);
    }
  }
  static bool is_corner_list(const Property &p) {
    return p.count_bytes && (p.name == "vertex_indices" || p.name == "vertex_index");
  }

  void add_face() {
    if (corner_.size() < 3) refuse("expected faces of three corners or more, got %zu", corner_.size());
    for (const double c : corner_)
      if (!(c >= 0.0 && c < static_cast<double>(surface_.vertex.size()) && c == std::floor(c)))
        refuse("expected corners below %zu, got %g", surface_.vertex.size(), c);
    for (std::size_t k = 2; k < corner_.size(); k++)
      surface_.face.emplace_back(static_cast<std::uint32_t>(corner_[0]),
                                 static_cast<std::uint32_t>(corner_[k - 1]),
                                 static_cast<std::uint32_t>(corner_[k]));
  }

  bool next_word(std::string_view *out) {
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_])))
      line_ += bytes_[at_++] == '\n';
    std::size_t end = at_;
    while (end < bytes_.size() && !std::isspace(static_cast<unsigned char>(bytes_[end])))
      end++;
    if (out) *out = std::string_view(bytes_).substr(at_, end - at_);
    const bool any = end > at_;
    if (out) at_ = end;
    return any;
  }

  double next_value(std::size_t bytes, bool floating, bool sign) {
    if (text_) {
      std::string_view word;
      double value = 0.0;
      if (!next_word(&word)) refuse("expected a number, got the end of the file");
      if (!parse_number(word, value)) refuse("expected a number, got \"%s\"", shown(word).c_str());
      return value;
    }
    if (bytes_.size() - at_ < bytes) refuse("expected a number, got the end of the file");
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < bytes; i++)
      bits |= std::uint64_t(static_cast<unsigned char>(bytes_[at_ + (big_ ? bytes - 1 - i : i)])) << (8 * i);
    at_ += bytes;
    if (floating && bytes == 4) {
      const auto low = static_cast<std::uint32_t>(bits);
      float value;
      std::memcpy(&value, &low, 4);
      return value;
    }
    if (floating) {
      double value;
      std::memcpy(&value, &bits, 8);
      return value;
    }
    if (sign && (bits >> (8 * bytes - 1) & 1u))
      return static_cast<double>(bits) - std::ldexp(1.0, static_cast<int>(8 * bytes));
    return static_cast<double>(bits);
  }

  [[noreturn]] void refuse(const char *format, ...) const CONCEG_PRINTF(2, 3) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (text_) fail(CONCEG_E_FORMAT, "%s:%zu: %s", path_.c_str(), line_, text);
    fail(CONCEG_E_FORMAT, "%s: byte %zu: %s", path_.c_str(), at_, text);
  }

  TextFile header_;
  const std::string &bytes_, &path_;
  bool text_ = true, big_ = false;
  std::vector<Element> elements_;
  std::vector<double> corner_;
  std::size_t at_ = 0, line_ = 1;
  Surface surface_;
};

// strand_00012_outer_erode_0.ply: number of the strand, outer or inner, erosion; false for another name.
bool strand_of(const std::string &name, std::uint64_t &strand, bool &inner, int &erosion) {
  char side[8] = "";
  unsigned long long number = 0;
  if (std::sscanf(name.c_str(), "strand_%llu_%5[a-z]_erode_%d.ply", &number, side, &erosion) != 3)
    return false;
  strand = number, inner = !std::strcmp(side, "inner");
  return inner || !std::strcmp(side, "outer");
}

} // namespace

Surface parse_ply(const std::string &bytes, const std::string &path) {
  return PlyReader(bytes, path).run();
}

// A file is a cell; of CACTUS' names inner and outer surface of a strand are one, and of several erosions the
// least is taken.
Scene read_ply_folder(const Request &request) {
  struct Member {
    std::string path;
    int erosion;
  };
  std::map<std::pair<std::uint64_t, std::string>, std::map<bool, Member>> cells;
  for (const std::string &path : find_files(request.names, {".ply"})) {
    std::uint64_t strand = 0;
    bool inner = false;
    int erosion = 0;
    const bool named = strand_of(base_name(path), strand, inner, erosion);
    auto &members =
        cells[named ? std::make_pair(strand, std::string()) : std::make_pair(~std::uint64_t{0}, path)];
    const auto found = members.find(inner);
    if (found == members.end() || erosion < found->second.erosion) members[inner] = {path, erosion};
  }
  Scene scene;
  std::size_t empty = 0, done = 0;
  for (const auto &[key, members] : cells) {
    must(conceg_ctx_progress(request.ctx, "reading PLY files", done++, cells.size()));
    SceneCell cell;
    cell.type = key.second.empty() ? "strand" : "surface",
    cell.cell_class = key.second.empty() ? "axon" : "other";
    if (!request.cell_class.empty()) cell.cell_class = cell.type = request.cell_class;
    const auto row = static_cast<std::uint32_t>(scene.cells.size());
    bool any = false;
    for (const auto &[inner, member] : members) {
      const std::string bytes = read_bytes(request.ctx, member.path);
      Surface surface = parse_ply(bytes, member.path);
      if (surface.face.empty()) { // CACTUS writes these for strands that failed
        empty++;
        continue;
      }
      if (!any) cell.soma = surface.vertex[0];
      any = true;
      const std::uint8_t code =
          key.second.empty() ? (!inner && members.count(true) ? CONCEG_MYELIN : CONCEG_AXON) : CONCEG_SOMA;
      scene.surfaces.push_back({row, code, std::move(surface)});
    }
    if (any) scene.cells.push_back(std::move(cell));
  }
  if (empty)
    conceg_ctx_log(request.ctx, CONCEG_LOG_WARNING,
                   "import: %zu files without faces (strands that failed) are left out", empty);
  if (scene.surfaces.empty())
    fail(CONCEG_E_FORMAT, "%s: expected surfaces with faces, got none", request.names[0].c_str());
  if (request.box_um > 0.0) scene.centred_box(glm::dvec3(request.box_um));
  check_frame(scene, request.names[0], "the files are taken to be in um and --box-um centred on the origin");
  return scene;
}

} // namespace conceg::importing
