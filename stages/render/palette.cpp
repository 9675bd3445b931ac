// SPDX-License-Identifier: BSD-3-Clause
#include "palette.hpp"

#include <glm/common.hpp>

#include <cmath>
#include <map>

namespace conceg::rendering {
namespace {

Colour hex(std::uint32_t rgb) {
  return Colour((rgb >> 16) & 255u, (rgb >> 8) & 255u, rgb & 255u) / 255.0f;
}

const std::vector<std::uint32_t> &shades(const std::string &class_name) {
  static const std::map<std::string, std::vector<std::uint32_t>> table = {
      {"pyramidal", {0x1F6FB5, 0x6DB6EC, 0x123F7A, 0x9FD0F5}},
      {"interneuron", {0xD1401F, 0xF59A3E, 0x9C1F2E, 0xFFC07A}},
      {"astrocyte", {0x1E9C73, 0x67C9A2, 0x0E6B4E, 0xA5DFC6}},
      {"microglia", {0x8B5BB5, 0xB995D8, 0x5E3487, 0xD7C0EA}},
      {"axon", {0xC9A21B, 0xE6CB5E, 0x8F7110, 0xF2E09C}},
      {"other", {0x7F8790, 0xABB2BA, 0x555C64, 0xCBD0D6}}};
  const auto found = table.find(class_name);
  return found == table.end() ? table.at("other") : found->second;
}

std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

} // namespace

std::vector<Colour> type_colours(const std::vector<std::string> &class_names) {
  std::map<std::string, std::size_t> used;
  std::vector<Colour> colours;
  for (const std::string &name : class_names) {
    const std::vector<std::uint32_t> &choice = shades(name);
    const std::size_t turn = used[name]++;
    // Past the last shade they start again, a little towards grey each time.
    const float grey = 0.25f * static_cast<float>(std::min<std::size_t>(turn / choice.size(), 3));
    colours.push_back(glm::mix(hex(choice[turn % choice.size()]), Colour(0.5f), grey));
  }
  return colours;
}

Colour cell_colour(const Colour &type, std::uint64_t id) {
  const float shift =
      static_cast<float>(mix_bits(id + 0x9e3779b97f4a7c15ull) >> 40) / static_cast<float>(1 << 24) - 0.5f;
  return shift > 0.0f ? glm::mix(type, Colour(1.0f), 0.24f * shift)
                      : glm::mix(type, Colour(0.0f), -0.24f * shift);
}

Colour to_linear(const Colour &srgb) {
  Colour out;
  for (int k = 0; k < 3; k++)
    out[k] = srgb[k] <= 0.04045f ? srgb[k] / 12.92f : std::pow((srgb[k] + 0.055f) / 1.055f, 2.4f);
  return out;
}

Colour to_srgb(const Colour &linear) {
  Colour out;
  for (int k = 0; k < 3; k++) {
    const float v = glm::clamp(linear[k], 0.0f, 1.0f);
    out[k] = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
  }
  return out;
}

} // namespace conceg::rendering
