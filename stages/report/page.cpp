// SPDX-License-Identifier: BSD-3-Clause
#include "page.hpp"

#include <string_view>

extern "C" const char conceg_report_viewer[];
extern "C" const unsigned long conceg_report_viewer_size;

namespace conceg::reporting {

namespace {
constexpr std::string_view slot = "<!--CONCEG-DATA-->";
}

std::string base64(const std::vector<std::uint8_t> &bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = (std::uint32_t{bytes[i]} << 16) |
                                (left > 1 ? std::uint32_t{bytes[i + 1]} << 8 : 0u) |
                                (left > 2 ? std::uint32_t{bytes[i + 2]} : 0u);
    out += digits[group >> 18], out += digits[(group >> 12) & 63u];
    out += left > 1 ? digits[(group >> 6) & 63u] : '=', out += left > 2 ? digits[group & 63u] : '=';
  }
  return out;
}

std::string data_elements(const std::string &json, const std::vector<Block> &blocks) {
  std::string out = "<script type=\"application/json\" id=\"facts\">" + json + "</script>\n";
  for (const Block &block : blocks)
    out += "<script type=\"application/base64\" id=\"" + block.name + "\">" + base64(block.bytes) +
           "</script>\n";
  return out;
}

void write_page(OutputFile &file, const std::string &json, const std::vector<Block> &blocks) {
  const std::string_view viewer(conceg_report_viewer, conceg_report_viewer_size);
  const std::size_t at = viewer.find(slot);
  if (at == std::string_view::npos) fail(CONCEG_E_INTERNAL, "the viewer has no %s", slot.data());
  file.write(viewer.data(), at);
  file.write(data_elements(json, blocks));
  file.write(viewer.data() + at + slot.size(), viewer.size() - at - slot.size());
}

} // namespace conceg::reporting
