// SPDX-License-Identifier: BSD-3-Clause
// The page of plot.hpp: the one file that knows Cairo.
#include "guard.hpp"
#include "plot.hpp"
#include "xml.hpp"

#include <cairo-svg.h>

#include <cctype>

namespace conceg::plot {

namespace {

// Of the fonts that stand for it fontconfig finds one everywhere.
constexpr const char *font_family = "Helvetica";
constexpr double line_tolerance = 0.05; // pt; no eye sees it
constexpr double full_turn = 6.283185307179586;

cairo_status_t collect(void *out, const unsigned char *bytes, unsigned count) {
  try {
    static_cast<std::string *>(out)->append(reinterpret_cast<const char *>(bytes), count);
    return CAIRO_STATUS_SUCCESS;
  } catch (...) { // no exception may pass through C
    return CAIRO_STATUS_NO_MEMORY;
  }
}

// Cairo names its group by a counter of the process, which would differ from run to run.
void fix_name(std::string &svg) {
  const std::string name = "<g id=\"surface";
  const std::size_t at = svg.find(name);
  if (at == std::string::npos) return;
  std::size_t end = at + name.size();
  while (end < svg.size() && std::isdigit(static_cast<unsigned char>(svg[end])))
    end++;
  svg.replace(at, end - at, "<g id=\"figure");
}

// Two decimals of every number are enough, and make the file a third smaller.
std::string shortened(const std::string &svg) {
  constexpr int decimals = 2;
  std::string out;
  int digits = -1; // since the point; -1 = before it
  for (const char c : svg) {
    const bool digit = c >= '0' && c <= '9';
    digits = c == '.' ? 0 : digit && digits >= 0 ? digits + 1 : -1;
    if (digits <= decimals) out += c;
  }
  return out;
}

void insert_title(std::string &svg, const std::string &title) {
  const std::size_t root = svg.find("<svg"), end = root == std::string::npos ? root : svg.find('>', root);
  if (end == std::string::npos) fail(CONCEG_E_STAGE, "Cairo: expected an SVG file, got something else");
  svg.insert(end + 1, "\n<title>" + escaped_xml(title) + "</title>");
}

void select_font(cairo_t *cairo, const TextStyle &style) {
  cairo_select_font_face(cairo, font_family, CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, style.size);
}

double advance(cairo_t *cairo, const std::string &words) {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, words.c_str(), &extents);
  return extents.x_advance;
}

void set_colour(cairo_t *cairo, const Colour &c) {
  cairo_set_source_rgba(cairo, c.red, c.green, c.blue, c.alpha);
}

void trace(cairo_t *cairo, const Line &line) {
  for (std::size_t i = 0; i < line.size(); i++)
    (i ? cairo_line_to : cairo_move_to)(cairo, line[i].x, line[i].y);
}

} // namespace

struct Page::Surface {
  std::string bytes;
  cairo_surface_t *surface = nullptr;
  cairo_t *cairo = nullptr;

  Surface(double width, double height) {
    surface = cairo_svg_surface_create_for_stream(collect, &bytes, width, height);
    cairo = cairo_create(surface);
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  }
  ~Surface() {
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
  }
  Surface(const Surface &) = delete;
  Surface &operator=(const Surface &) = delete;
};

Page::Page(double width, double height) : surface_(std::make_unique<Surface>(width, height)) {
  area({{0.0, 0.0}, {width, 0.0}, {width, height}, {0.0, height}}, rgb(0xFFFFFF));
}
Page::~Page() = default;

void Page::lines(const std::vector<Line> &all, const Colour &colour, double width, bool round) {
  cairo_t *cairo = surface_->cairo;
  for (const Line &line : all)
    trace(cairo, simplified(line, line_tolerance));
  set_colour(cairo, colour);
  cairo_set_line_width(cairo, width);
  cairo_set_line_cap(cairo, round ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  cairo_stroke(cairo);
}

void Page::dashes(const Line &line, const Colour &colour, double width) {
  const double pattern[] = {2.0, 2.0};
  cairo_set_dash(surface_->cairo, pattern, 2, 0.0);
  lines({line}, colour, width);
  cairo_set_dash(surface_->cairo, nullptr, 0, 0.0);
}

void Page::area(const Line &outline, const Colour &colour) {
  trace(surface_->cairo, outline);
  cairo_close_path(surface_->cairo);
  set_colour(surface_->cairo, colour);
  cairo_fill(surface_->cairo);
}

void Page::disc(const Point &center, double radius, const Colour &colour) {
  cairo_new_sub_path(surface_->cairo);
  cairo_arc(surface_->cairo, center.x, center.y, radius, 0.0, full_turn);
  set_colour(surface_->cairo, colour);
  cairo_fill(surface_->cairo);
}

void Page::dots(const std::vector<Point> &places, double diameter, const Colour &colour) {
  std::vector<Line> points; // lines without length: their round caps are the dots
  for (const Point &place : places)
    points.push_back({place, place});
  lines(points, colour, diameter, true);
}

void Page::text(const Point &baseline, const std::string &words, const TextStyle &style) {
  cairo_t *cairo = surface_->cairo;
  select_font(cairo, style);
  const double width = advance(cairo, words), before = style.anchor == Anchor::left     ? 0.0
                                                       : style.anchor == Anchor::middle ? width / 2.0
                                                                                        : width;
  set_colour(cairo, style.colour);
  cairo_save(cairo);
  cairo_translate(cairo, baseline.x, baseline.y);
  if (style.upwards) cairo_rotate(cairo, -full_turn / 4.0);
  cairo_move_to(cairo, -before, 0.0);
  cairo_show_text(cairo, words.c_str());
  cairo_restore(cairo);
  cairo_new_path(cairo);
}

double Page::text_width(const std::string &words, const TextStyle &style) {
  select_font(surface_->cairo, style);
  return advance(surface_->cairo, words);
}

void Page::clip(const Box &box) {
  cairo_save(surface_->cairo);
  cairo_rectangle(surface_->cairo, box.left, box.top, box.width, box.height);
  cairo_clip(surface_->cairo);
}
void Page::unclip() {
  cairo_restore(surface_->cairo);
}

std::string Page::svg(const std::string &title) {
  cairo_status_t status = cairo_status(surface_->cairo);
  cairo_surface_finish(surface_->surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface_->surface);
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS) fail(CONCEG_E_STAGE, "Cairo: %s", cairo_status_to_string(status));
  std::string out = shortened(surface_->bytes);
  fix_name(out);
  insert_title(out, title);
  return out;
}

} // namespace conceg::plot
