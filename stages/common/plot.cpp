// SPDX-License-Identifier: BSD-3-Clause
#include "plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace conceg::plot {
namespace {

const Colour ink = rgb(0x222222);
constexpr double axis_width = 0.5, tick_length = 2.5, number_size = 6.0, label_size = 7.0;

// The steps of round numbers: 1, 2 and 5 times powers of ten.
double power_of_ten(double value) {
  return std::pow(10.0, std::floor(std::log10(value) + 1e-9));
}

// From a point to the segment a b.
double distance_to(const Point &p, const Point &a, const Point &b) {
  const double x = b.x - a.x, y = b.y - a.y, square = x * x + y * y;
  const double along =
      square > 0.0 ? std::clamp(((p.x - a.x) * x + (p.y - a.y) * y) / square, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - along * x, p.y - a.y - along * y);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", std::fabs(value) < 1e-12 ? 0.0 : value);
  return text;
}

} // namespace

Colour rgb(std::uint32_t value, double alpha) {
  return {((value >> 16) & 255u) / 255.0, ((value >> 8) & 255u) / 255.0, (value & 255u) / 255.0, alpha};
}

std::vector<Box> columns(const Box &box, std::size_t count, double gap) {
  const double width = (box.width - gap * static_cast<double>(count - 1)) / static_cast<double>(count);
  std::vector<Box> out;
  for (std::size_t i = 0; i < count; i++)
    out.push_back({box.left + static_cast<double>(i) * (width + gap), box.top, width, box.height});
  return out;
}

Line simplified(const Line &line, double tolerance) {
  if (line.size() < 3) return line;
  std::vector<bool> kept(line.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> spans{{0, line.size() - 1}};
  while (!spans.empty()) {
    const auto [first, last] = spans.back();
    spans.pop_back();
    std::size_t farthest = first;
    double distance = tolerance;
    for (std::size_t i = first + 1; i < last; i++) {
      const double off = distance_to(line[i], line[first], line[last]);
      if (off > distance) distance = off, farthest = i;
    }
    if (farthest == first) continue;
    kept[farthest] = true;
    spans.push_back({first, farthest}), spans.push_back({farthest, last});
  }
  Line out;
  for (std::size_t i = 0; i < line.size(); i++)
    if (kept[i]) out.push_back(line[i]);
  return out;
}

double round_up(double value) {
  const double power = power_of_ten(value);
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= value * (1.0 - 1e-9)) return step * power;
  return 10.0 * power;
}

double round_down(double value) {
  const double power = power_of_ten(value);
  for (const double step : {5.0, 2.0})
    if (step * power <= value * (1.0 + 1e-9)) return step * power;
  return power;
}

std::vector<double> round_ticks(double low, double high, unsigned most) {
  const double step = round_up((high - low) / std::max(1u, most - 1));
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0)
    ticks.push_back(k * step);
  return ticks;
}

Panel::Panel(Page &page, const Box &box, const Axis &x, const Axis &y)
    : page_(page), box_(box), x_(x), y_(y) {}

Point Panel::place(double x, double y) const {
  return {box_.left + box_.width * (x - x_.low) / (x_.high - x_.low),
          box_.top + box_.height * (y_.high - y) / (y_.high - y_.low)};
}

void Panel::axes(bool y_axis) {
  const double bottom = box_.top + box_.height, middle = box_.left + box_.width / 2.0;
  std::vector<Line> strokes{{{box_.left, bottom}, {box_.left + box_.width, bottom}}};
  if (y_axis) strokes.push_back({{box_.left, box_.top}, {box_.left, bottom}});
  double widest = 0.0;
  for (const double tick : x_.numbers ? round_ticks(x_.low, x_.high, x_.ticks) : std::vector<double>()) {
    const double at = place(tick, y_.low).x;
    strokes.push_back({{at, bottom}, {at, bottom + tick_length}});
    page_.text({at, bottom + tick_length + 6.5}, number(tick), {number_size, ink, Anchor::middle});
  }
  for (const double tick :
       y_axis &&y_.numbers ? round_ticks(y_.low, y_.high, y_.ticks) : std::vector<double>()) {
    const double at = place(x_.low, tick).y;
    const TextStyle style{number_size, ink, Anchor::right};
    strokes.push_back({{box_.left - tick_length, at}, {box_.left, at}});
    page_.text({box_.left - tick_length - 2.0, at + 2.1}, number(tick), style);
    widest = std::max(widest, tick_length + 2.0 + page_.text_width(number(tick), style));
  }
  page_.lines(strokes, ink, axis_width);
  page_.text({middle, bottom + (x_.numbers ? 18.0 : 9.0)}, x_.label, {label_size, ink, Anchor::middle});
  page_.text({box_.left - widest - 4.5, box_.top + box_.height / 2.0}, y_.label,
             {label_size, ink, Anchor::middle, false, true});
}

void Panel::line(const Line &data, const Colour &colour, double width) {
  Line placed;
  for (const Point &p : data)
    placed.push_back(place(p.x, p.y));
  page_.lines({placed}, colour, width);
}

void Panel::dashes(const Line &data, const Colour &colour, double width) {
  Line placed;
  for (const Point &p : data)
    placed.push_back(place(p.x, p.y));
  page_.dashes(placed, colour, width);
}

void Panel::dots(const std::vector<Point> &data, double diameter, const Colour &colour) {
  std::vector<Point> placed;
  for (const Point &p : data)
    placed.push_back(place(p.x, p.y));
  page_.dots(placed, diameter, colour);
}

Histogram histogram(const std::vector<double> &values, double low, double high, std::size_t bins) {
  Histogram out{low, high, std::vector<double>(bins, 0.0)};
  for (const double value : values) {
    if (!(value >= low && value <= high)) continue;
    const double bin = std::floor((value - low) / (high - low) * static_cast<double>(bins));
    out.share[std::min(bins - 1, static_cast<std::size_t>(bin))] += 1.0 / static_cast<double>(values.size());
  }
  return out;
}

Line Histogram::steps() const {
  const double width = (high - low) / static_cast<double>(share.size());
  Line out{{low, 0.0}};
  for (std::size_t i = 0; i < share.size(); i++) {
    out.push_back({low + width * static_cast<double>(i), share[i]});
    out.push_back({low + width * static_cast<double>(i + 1), share[i]});
  }
  out.push_back({high, 0.0});
  return out;
}

double kernel_width(const std::vector<double> &values, std::size_t count) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values)
    sum += value;
  for (const double value : values)
    squares += (value - sum / n) * (value - sum / n);
  const double middle = (quantile(values, 0.75) - quantile(values, 0.25)) / 1.34, sd = std::sqrt(squares / n);
  return 0.9 * (middle > 0.0 ? std::min(sd, middle) : sd) * std::pow(static_cast<double>(count), -0.2);
}

Line density(const std::vector<double> &values, const Bounds &bounds, double width) {
  constexpr int points = 120;
  const double height =
      1.0 / (static_cast<double>(values.size()) * width * std::sqrt(2.0 * 3.14159265358979324));
  const auto kernel = [width](double distance) {
    return std::exp(-0.5 * distance * distance / (width * width));
  };
  Line out;
  for (int k = 0; k <= points; k++) {
    const double x = bounds.low + (bounds.high - bounds.low) * k / points;
    double sum = 0.0;
    for (const double value : values) {
      sum += kernel(x - value);
      if (bounds.closed_low) sum += kernel(x - (2.0 * bounds.low - value));
      if (bounds.closed_high) sum += kernel(x - (2.0 * bounds.high - value));
    }
    out.push_back({x, sum * height});
  }
  return out;
}

double quantile(std::vector<double> values, double at) {
  if (values.empty()) return 0.0;
  const auto place = static_cast<std::size_t>(at * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(place), values.end());
  return values[place];
}

void legend(Page &page, const Point &baseline, const std::vector<Key> &keys, Anchor anchor) {
  constexpr double stroke = 10.0, gap = 3.0, between = 10.0;
  const TextStyle style{label_size, ink};
  double width = -between;
  for (const Key &key : keys)
    width += stroke + gap + page.text_width(key.label, style) + between;
  double at = baseline.x - (anchor == Anchor::right ? width : anchor == Anchor::middle ? width / 2.0 : 0.0);
  for (const Key &key : keys) {
    page.lines({{{at, baseline.y - 2.2}, {at + stroke, baseline.y - 2.2}}}, key.colour, key.width);
    page.text({at + stroke + gap, baseline.y}, key.label, style);
    at += stroke + gap + page.text_width(key.label, style) + between;
  }
}

void scale_bar(Page &page, const Point &at, double length, double scale, const std::string &label) {
  const double end = at.x + length * scale;
  page.lines({{at, {end, at.y}}}, ink, 1.2);
  page.text({(at.x + end) / 2.0, at.y - 3.5}, label, {label_size, ink, Anchor::middle});
}

} // namespace conceg::plot
