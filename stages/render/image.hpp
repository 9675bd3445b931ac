// SPDX-License-Identifier: BSD-3-Clause
// A picture in memory and the few things drawn on it: blended pixels, smooth lines, text. Pixel (0, 0) is the
// top left one; pixel centres lie at half numbers.
#pragma once

#include "palette.hpp"

#include <glm/vec2.hpp>

#include <string>
#include <utility>
#include <vector>

namespace conceg::rendering {

struct Image {
  int width = 0, height = 0;
  std::vector<Colour> pixel; // sRGB, row by row
  Image() = default;
  Image(int w, int h, const Colour &fill)
      : width(w), height(h), pixel(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
  Colour &at(int x, int y) {
    return pixel[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  const Colour &at(int x, int y) const { return const_cast<Image *>(this)->at(x, y); }
};

using Stroke = std::pair<glm::dvec2, glm::dvec2>;

// Strokes of one colour and one width with round ends; where they overlap they are not darker.
void draw_strokes(Image &image, const std::vector<Stroke> &strokes, double width, const Colour &colour,
                  double opacity = 1.0);
// A filled rectangle; its borders are sharp.
void fill_rectangle(Image &image, int left, int top, int right, int bottom, const Colour &colour);
// Text with the built-in strokes: `height` is that of capital letters; (x, y) is the left end of the base
// line.
void draw_text(Image &image, const std::string &text, double x, double y, double height,
               const Colour &colour);
double text_width(const std::string &text, double height);

} // namespace conceg::rendering
