// SPDX-License-Identifier: BSD-3-Clause
// A tiny stroke font: letters, digits and a few signs as lines and smoothed curves, so that pictures need no
// font file.
#pragma once

#include "image.hpp"

namespace conceg::rendering {

// Strokes of the text; units of the height of capital letters, y up from the base line. UTF-8; an unknown
// character is a box.
std::vector<Stroke> text_strokes(const std::string &text);
double text_advance(const std::string &text);

} // namespace conceg::rendering
