// SPDX-License-Identifier: BSD-3-Clause
#include "folder.hpp"

namespace conceg::exporting {

OutputFolder::OutputFolder(const std::string &path) : path_(path) {
  if (path_.empty()) fail(CONCEG_E_PARAM, "dir: expected the name of a folder, got an empty text");
  while (path_.size() > 1 && path_.back() == '/')
    path_.pop_back();
  make_folder(path_);
}

std::string OutputFolder::at(const std::string &file) {
  const std::string full = path_ + "/" + file;
  const std::string folder = full.substr(0, full.rfind('/'));
  if (made_.insert(folder).second) make_folder(folder);
  return full;
}

void OutputFolder::write_index() {
  OutputFile file(at("index.csv"));
  file.write("file,what,cell,id,type,layer,points,faces\n");
  for (const Written &row : written_) {
    const bool one = row.cell >= 0;
    file.write(quoted_csv(row.file) + "," + row.what + "," + (one ? std::to_string(row.cell) : "") + "," +
               (one ? std::to_string(row.id) : "") + "," + quoted_csv(row.type) + "," +
               quoted_csv(row.layer) + "," + std::to_string(row.points) + "," + std::to_string(row.faces) +
               "\n");
  }
  file.commit();
}

std::string quoted_csv(const std::string &text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

std::string quoted_json(const std::string &text) {
  std::string out = "\"";
  char code[24];
  for (std::size_t i = 0; i < text.size(); i++) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += text[i];
    } else if (c >= 0x20 && c < 0x7f) {
      out += text[i];
    } else {
      std::uint32_t value = c >= 0xF0 ? c & 7u : c >= 0xE0 ? c & 15u : c >= 0xC0 ? c & 31u : c;
      for (int more = c >= 0xF0   ? 3
                      : c >= 0xE0 ? 2
                      : c >= 0xC0 ? 1
                                  : 0;
           more > 0 && i + 1 < text.size(); more--)
        value = (value << 6) | (static_cast<unsigned char>(text[++i]) & 63u);
      if (value > 0xffffu)
        std::snprintf(code, sizeof code, "\\u%04x\\u%04x", 0xd800u + ((value - 0x10000u) >> 10 & 0x3ffu),
                      0xdc00u + (value & 0x3ffu));
      else
        std::snprintf(code, sizeof code, "\\u%04x", value);
      out += code;
    }
  }
  return out + "\"";
}

std::string cell_file_name(std::uint64_t cell, const std::string &type) {
  char number[32];
  std::snprintf(number, sizeof number, "cell_%04llu", static_cast<unsigned long long>(cell));
  std::string name = number;
  bool gap = true;
  for (const char c : type) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (c == '/') continue; // "L2/3" becomes "L23"
    if (plain && gap) name += '_';
    if (plain) name += c;
    gap = !plain;
  }
  return name;
}

} // namespace conceg::exporting
