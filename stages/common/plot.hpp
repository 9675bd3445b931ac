// SPDX-License-Identifier: BSD-3-Clause
// Figures as SVG, drawn by Cairo without a display: pages, panels with axes, histograms, drawings to scale.
// Places on the page are in pt (1/72 inch) from its upper left corner, y down.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace conceg::plot {

struct Colour {
  double red = 0.0, green = 0.0, blue = 0.0, alpha = 1.0;
};
// From 0xRRGGBB.
Colour rgb(std::uint32_t value, double alpha = 1.0);

struct Point {
  double x = 0.0, y = 0.0;
};
using Line = std::vector<Point>;

struct Box {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
};
// `count` boxes side by side, `gap` apart.
std::vector<Box> columns(const Box &box, std::size_t count, double gap);

enum class Anchor { left, middle, right };
struct TextStyle {
  double size = 7.0;
  Colour colour;
  Anchor anchor = Anchor::left;
  bool bold = false, upwards = false; // upwards: turned by 90 degree
};

// The line without the points that lie nearer than `tolerance` to it (Douglas and Peucker).
Line simplified(const Line &line, double tolerance);

// One page. Same calls = same bytes, with the same fonts.
class Page {
public:
  Page(double width, double height);
  ~Page();
  Page(const Page &) = delete;
  Page &operator=(const Page &) = delete;

  // All lines become one path; their ends are flat or round. Points that lie on their line to within 0.05 pt
  // are left out.
  void lines(const std::vector<Line> &lines, const Colour &colour, double width, bool round = false);
  void dashes(const Line &line, const Colour &colour, double width);
  void area(const Line &outline, const Colour &colour);
  void disc(const Point &center, double radius, const Colour &colour);
  // All dots become one path.
  void dots(const std::vector<Point> &places, double diameter, const Colour &colour);
  void text(const Point &baseline, const std::string &words, const TextStyle &style);
  double text_width(const std::string &words, const TextStyle &style);
  // What is drawn until unclip() ends at the box.
  void clip(const Box &box);
  void unclip();
  // Ends the page. `title` is its <title>, for readers that show or search it.
  std::string svg(const std::string &title);

private:
  struct Surface;
  std::unique_ptr<Surface> surface_;
};

// Round values (1, 2 or 5 times a power of ten apart) within low .. high, `most` of them at most, 2 or more.
std::vector<double> round_ticks(double low, double high, unsigned most);
// The smallest 1, 2 or 5 times a power of ten that is not below `value` > 0, and the largest not above it.
double round_up(double value);
double round_down(double value);

struct Axis {
  double low = 0.0, high = 1.0;
  std::string label; // with its unit
  unsigned ticks = 5;
  bool numbers = true; // ticks and their numbers; the label alone otherwise
};

// A box of the page with data coordinates: x to the right, y up.
class Panel {
public:
  Panel(Page &page, const Box &box, const Axis &x, const Axis &y);
  // The lines at the left and at the bottom with ticks, numbers and labels; `y_axis` false leaves the left
  // out.
  void axes(bool y_axis = true);
  Point place(double x, double y) const;
  void line(const Line &data, const Colour &colour, double width);
  void dashes(const Line &data, const Colour &colour, double width);
  void dots(const std::vector<Point> &data, double diameter, const Colour &colour);

private:
  Page &page_;
  Box box_;
  Axis x_, y_;
};

// Shares of values in equal bins between low and high. The shares are of all values, so that they sum to less
// than 1 when some lie outside.
struct Histogram {
  double low = 0.0, high = 1.0;
  std::vector<double> share;
  // Its outline, from the axis to the axis.
  Line steps() const;
};
Histogram histogram(const std::vector<double> &values, double low, double high, std::size_t bins);

// Where a density ends: at a bound that values cannot pass, their kernels are reflected.
struct Bounds {
  double low = 0.0, high = 1.0;
  bool closed_low = false, closed_high = false;
};
// Width of a Gaussian kernel for `count` values that spread as `values` do (Silverman's rule).
double kernel_width(const std::vector<double> &values, std::size_t count);
// Density by Gaussian kernels of `width` > 0; its integral over all values is 1.
Line density(const std::vector<double> &values, const Bounds &bounds, double width);

// Where the sorted values reach the share `at` of their number; 0 without values.
double quantile(std::vector<double> values, double at);

struct Key {
  std::string label;
  Colour colour;
  double width = 2.0; // of the stroke that stands for it
};
// One line of keys that starts, or with Anchor::right ends, at the baseline.
void legend(Page &page, const Point &baseline, const std::vector<Key> &keys, Anchor anchor);

// A bar of `length` units at `scale` pt a unit, its left end at `at`, with its label above.
void scale_bar(Page &page, const Point &at, double length, double scale, const std::string &label);

} // namespace conceg::plot
