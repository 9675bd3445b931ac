// SPDX-License-Identifier: BSD-3-Clause
// Colours of cell types: a hue per class that colour-blind readers can tell apart, a shade per type, a hint
// of variation per cell. Values are sRGB in [0, 1].
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::rendering {

using Colour = glm::vec3;

// One colour per type, in the order of the types; types of one class take successive shades of its hue.
std::vector<Colour> type_colours(const std::vector<std::string> &class_names);

// The type's colour, up to 12 % lighter or darker, fixed by the cell's stable id.
Colour cell_colour(const Colour &type, std::uint64_t id);

Colour to_linear(const Colour &srgb);
Colour to_srgb(const Colour &linear);

} // namespace conceg::rendering
