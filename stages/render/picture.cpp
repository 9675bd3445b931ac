// SPDX-License-Identifier: BSD-3-Clause
#include "picture.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace conceg::rendering {
namespace {

const Colour paper(1.0f), ink(0.13f, 0.15f, 0.19f), faint(0.45f, 0.48f, 0.53f), membrane(0.10f, 0.11f, 0.14f),
    extracellular(0.955f, 0.945f, 0.92f);
constexpr int smallest_px = 64;

// Where things stand: the plot at the left, the column at the right, with one margin around both.
struct Layout {
  int width, height, margin, column_left;
  double text; // height of capital letters, pixels
  Frame plot;
};

Layout lay_out(const glm::dvec2 &extent_um, int size_px, int samples) {
  const double size = std::max(size_px, smallest_px), margin = 0.028 * size, column = 0.235 * size,
               column_height = 0.55 * size;
  const double um_per_pixel =
      std::max(extent_um.x / (size - column - 3.0 * margin), extent_um.y / (size - 2.0 * margin));
  Layout layout;
  layout.margin = static_cast<int>(margin);
  layout.plot.left = layout.plot.top = layout.margin;
  layout.plot.width = std::max(1, static_cast<int>(std::ceil(extent_um.x / um_per_pixel)));
  layout.plot.height = std::max(1, static_cast<int>(std::ceil(extent_um.y / um_per_pixel)));
  layout.plot.um_per_pixel = um_per_pixel;
  layout.plot.samples_per_side = std::max(1, static_cast<int>(std::ceil(std::sqrt(samples) - 1e-9)));
  layout.column_left = layout.plot.left + layout.plot.width + layout.margin;
  layout.width = std::min(static_cast<int>(size), static_cast<int>(layout.column_left + column + margin));
  layout.height = std::min(static_cast<int>(size),
                           std::max(layout.plot.height, static_cast<int>(column_height)) + 2 * layout.margin);
  // The longer side is the size that was asked for, to the pixel.
  (layout.width >= layout.height ? layout.width : layout.height) = static_cast<int>(size);
  layout.text = size / 84.0;
  return layout;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// The column's contents from top to bottom; each call moves down.
class Column {
public:
  Column(Image &image, const Layout &layout)
      : image_(image), layout_(layout), y_(layout.margin + 1.6 * layout.text) {}

  void line(const std::string &text, const Colour &colour, double scale = 1.0) {
    double height = scale * layout_.text;
    const double room = image_.width - layout_.column_left - 0.5 * layout_.margin,
                 width = text_width(text, height);
    if (width > room) height *= room / width;
    draw_text(image_, text, layout_.column_left, y_, height, colour);
    y_ += 2.1 * scale * layout_.text;
  }
  void gap(double lines) { y_ += lines * layout_.text; }
  void types(const Scene &scene) {
    std::vector<std::size_t> count(scene.types.size(), 0);
    for (const Body &body : scene.bodies)
      count[body.type]++;
    for (std::size_t t = 0; t < scene.types.size(); t++) {
      if (!count[t]) continue;
      const int left = layout_.column_left, side = static_cast<int>(1.25 * layout_.text),
                top = static_cast<int>(y_ - 1.12 * layout_.text);
      fill_rectangle(image_, left, top, left + side, top + side, scene.type_colour[t]);
      const std::string text = scene.types[t] + " (" + std::to_string(count[t]) + ")";
      const double x = left + 2.0 * layout_.text, room = image_.width - x - 0.5 * layout_.margin,
                   width = text_width(text, layout_.text);
      draw_text(image_, text, x, y_, layout_.text * std::min(1.0, room / width), ink);
      y_ += 2.1 * layout_.text;
    }
  }
  void scale_bar(double um_per_pixel) {
    const double um = scale_bar_um(0.85 * (image_.width - layout_.column_left - layout_.margin) *
                                   um_per_pixel),
                 length = um / um_per_pixel;
    const double left = layout_.column_left, y = y_ + 0.4 * layout_.text, tick = 0.45 * layout_.text;
    draw_strokes(image_,
                 {{{left, y}, {left + length, y}},
                  {{left, y - tick}, {left, y + tick}},
                  {{left + length, y - tick}, {left + length, y + tick}}},
                 std::max(1.5, 0.17 * layout_.text), ink);
    draw_text(image_, number(um) + " \xC2\xB5m", left, y + 2.1 * layout_.text, layout_.text, ink);
    y_ += 4.6 * layout_.text;
  }
  // `direction` in the picture (y up), shortened where the pia points towards the viewer.
  void pia(const glm::dvec2 &direction) {
    const double length = 4.6 * layout_.text, shown = glm::length(direction);
    if (shown < 0.15) return;
    const glm::dvec2 along(direction.x * length, -direction.y * length);
    const glm::dvec2 tail(layout_.column_left + 1.2 * layout_.text + std::max(0.0, -along.x),
                          y_ + std::max(0.0, -along.y)),
        tip = tail + along;
    const glm::dvec2 back = -glm::normalize(along) * 0.95 * layout_.text, off(-back.y * 0.55, back.x * 0.55);
    draw_strokes(image_, {{tail, tip}, {tip, tip + back + off}, {tip, tip + back - off}},
                 std::max(1.5, 0.17 * layout_.text), ink);
    draw_text(image_, "pia", std::max(tail.x, tip.x) + 0.9 * layout_.text,
              0.5 * (tail.y + tip.y) + 0.5 * layout_.text, layout_.text, ink);
    y_ += std::fabs(along.y) + 1.5 * layout_.text;
  }

private:
  Image &image_;
  const Layout &layout_;
  double y_;
};

std::string box_text(const Scene &scene) {
  const glm::dvec3 size = side(scene.box);
  return number(size.x) + " \xC3\x97 " + number(size.y) + " \xC3\x97 " + number(size.z) + " \xC2\xB5m";
}

std::string cells_text(const Scene &scene) {
  return std::to_string(scene.bodies.size()) + (scene.bodies.size() == 1 ? " cell" : " cells");
}

// Draws the plane's map, reduced to pixels.
void paint_map(Image &image, const Frame &view, const Scene &scene, const CutMap &map) {
  std::vector<Colour> fill;
  for (const Body &body : scene.bodies)
    fill.push_back(glm::mix(body.colour, Colour(1.0f), 0.16f));
  const int s = view.samples_per_side;
  for (int y = 0; y < view.height; y++)
    for (int x = 0; x < view.width; x++) {
      Colour sum(0.0f);
      for (int j = 0; j < s; j++)
        for (int i = 0; i < s; i++) {
          const std::size_t at = static_cast<std::size_t>(y * s + j) * static_cast<std::size_t>(map.width) +
                                 static_cast<std::size_t>(x * s + i);
          sum += map.membrane[at]    ? membrane
                 : map.body[at] >= 0 ? fill[static_cast<std::size_t>(map.body[at])]
                                     : extracellular;
        }
      image.at(view.left + x, view.top + y) = sum / static_cast<float>(s * s);
    }
}

} // namespace

double scale_bar_um(double longest_um) {
  double unit = std::pow(10.0, std::floor(std::log10(longest_um)));
  if (unit > longest_um) unit /= 10.0;
  return longest_um >= 5.0 * unit ? 5.0 * unit : longest_um >= 2.0 * unit ? 2.0 * unit : unit;
}

Image picture_of_cells(const Scene &scene, const PictureOptions &options, Workers &workers,
                       const Progress &progress) {
  const Camera camera(scene, options.azimuth_deg, options.elevation_deg);
  const Layout layout = lay_out(camera.extent() * 1.01, options.size_px, options.samples);
  Image image(layout.width, layout.height, paper);
  const std::shared_ptr<const RayScene> rays = make_ray_scene(scene, workers.threads());
  draw_scene(image, layout.plot, scene, *rays, camera, workers, progress);
  Column column(image, layout);
  column.line(cells_text(scene), ink, 1.25);
  column.line(box_text(scene), faint);
  column.gap(1.0);
  column.types(scene);
  column.gap(1.2);
  column.scale_bar(layout.plot.um_per_pixel);
  column.pia({glm::dot(scene.pia, camera.right()), glm::dot(scene.pia, camera.up())});
  return image;
}

Image picture_of_cut(const Scene &scene, const PictureOptions &options, Workers &workers,
                     const Progress &progress) {
  const double position = scene.lo[options.cut_axis] +
                          options.cut_position * (scene.hi[options.cut_axis] - scene.lo[options.cut_axis]);
  const CutPlane plane = cut_plane(options.cut_axis, position);
  const glm::dvec3 size = scene.hi - scene.lo;
  const Layout layout = lay_out({size[plane.across], size[plane.up]}, options.size_px, options.samples);
  const Frame &view = layout.plot;
  const double line_um = 1.5 * view.um_per_pixel;
  const CutMap map = cut(scene, plane, view.width * view.samples_per_side,
                         view.height * view.samples_per_side, line_um, workers, progress);
  Image image(layout.width, layout.height, paper);
  paint_map(image, view, scene, map);
  const double l = view.left - 0.5, t = view.top - 0.5, r = view.left + view.width + 0.5,
               b = view.top + view.height + 0.5;
  draw_strokes(image, {{{l, t}, {r, t}}, {{r, t}, {r, b}}, {{r, b}, {l, b}}, {{l, b}, {l, t}}}, 1.6, ink);
  Column column(image, layout);
  column.line(std::string("cut at ") + "xyz"[plane.axis] + " = " + number(position) + " \xC2\xB5m", ink,
              1.25);
  column.line("cells cover " + number(std::round(1000.0 * map.covered) / 10.0) + " %", faint);
  column.gap(1.0);
  column.types(scene);
  column.gap(1.2);
  column.scale_bar(view.um_per_pixel);
  column.pia({scene.pia[plane.across], scene.pia[plane.up]});
  return image;
}

} // namespace conceg::rendering
