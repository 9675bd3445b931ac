// SPDX-License-Identifier: BSD-3-Clause
#include "image.hpp"

#include "font.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::rendering {
namespace {

double distance_to(const Stroke &stroke, const glm::dvec2 &p) {
  const glm::dvec2 along = stroke.second - stroke.first, to = p - stroke.first;
  const double length2 = glm::dot(along, along);
  const double share = length2 > 0.0 ? glm::clamp(glm::dot(to, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(to - share * along);
}

// Pixels that a stroke of this half width may touch, cut to the image; from > to when it touches none.
void touched(const Image &image, const Stroke &stroke, double reach, glm::ivec2 &from, glm::ivec2 &to) {
  const glm::dvec2 low = glm::min(stroke.first, stroke.second) - reach,
                   high = glm::max(stroke.first, stroke.second) + reach;
  const glm::dvec2 last(image.width - 1, image.height - 1);
  from = glm::ivec2(glm::clamp(glm::floor(low), glm::dvec2(0.0), last + 1.0));
  to = glm::ivec2(glm::clamp(glm::floor(high), glm::dvec2(-1.0), last));
}

} // namespace

void draw_strokes(Image &image, const std::vector<Stroke> &strokes, double width, const Colour &colour,
                  double opacity) {
  const double half = 0.5 * width, reach = half + 1.0;
  glm::ivec2 low(image.width, image.height), high(-1), from, to;
  for (const Stroke &stroke : strokes) {
    touched(image, stroke, reach, from, to);
    if (from.x > to.x || from.y > to.y) continue;
    low = glm::min(low, from), high = glm::max(high, to);
  }
  if (low.x > high.x || low.y > high.y) return;
  const glm::ivec2 size = high - low + 1;
  std::vector<float> cover(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 0.0f);
  for (const Stroke &stroke : strokes) {
    touched(image, stroke, reach, from, to);
    for (int y = from.y; y <= to.y; y++)
      for (int x = from.x; x <= to.x; x++) {
        const double d = distance_to(stroke, {x + 0.5, y + 0.5});
        float &cell = cover[static_cast<std::size_t>(y - low.y) * static_cast<std::size_t>(size.x) +
                            static_cast<std::size_t>(x - low.x)];
        cell = std::max(cell, static_cast<float>(glm::clamp(half + 0.5 - d, 0.0, 1.0)));
      }
  }
  for (int y = low.y; y <= high.y; y++)
    for (int x = low.x; x <= high.x; x++) {
      const float share = cover[static_cast<std::size_t>(y - low.y) * static_cast<std::size_t>(size.x) +
                                static_cast<std::size_t>(x - low.x)];
      image.at(x, y) = glm::mix(image.at(x, y), colour, share * static_cast<float>(opacity));
    }
}

void fill_rectangle(Image &image, int left, int top, int right, int bottom, const Colour &colour) {
  for (int y = std::max(top, 0); y < std::min(bottom, image.height); y++)
    for (int x = std::max(left, 0); x < std::min(right, image.width); x++)
      image.at(x, y) = colour;
}

void draw_text(Image &image, const std::string &text, double x, double y, double height,
               const Colour &colour) {
  std::vector<Stroke> strokes = text_strokes(text);
  for (Stroke &stroke : strokes)
    for (glm::dvec2 *p : {&stroke.first, &stroke.second})
      *p = glm::dvec2(x + p->x * height, y - p->y * height);
  draw_strokes(image, strokes, std::max(1.1, 0.13 * height), colour);
}

double text_width(const std::string &text, double height) {
  return height * text_advance(text);
}

} // namespace conceg::rendering
