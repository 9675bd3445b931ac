// SPDX-License-Identifier: BSD-3-Clause
#include "pictures.hpp"

#include "output.hpp"
#include "plot.hpp"

#include "conceg/portable.h"

#include <algorithm>
#include <cmath>

namespace conceg::fit {
namespace {

using namespace plot;

const Colour black = rgb(0x000000);
const std::uint32_t palette[] = {0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7};
constexpr double width = 510.0, height = 190.0;

double log10_of(double value) {
  return conceg_log(std::max(value, 1e-12)) / 2.30258509299404568402;
}

using Place = Point (*)(double b, double signal);
Point semilog(double b, double signal) {
  return {b, log10_of(signal)};
}
Point by_root(double b, double signal) {
  return {1.0 / std::sqrt(b), signal};
}

double lowest(const std::vector<double> &values) {
  return *std::min_element(values.begin(), values.end());
}
double highest(const std::vector<double> &values) {
  return *std::max_element(values.begin(), values.end());
}

struct Drawn {
  const Shells *shells;
  std::vector<const Result *> fits;
};

void draw_panel(Page &page, const Box &box, const Drawn &drawn, const Axis &x, const Axis &y, Place place) {
  Panel panel(page, box, x, y);
  panel.axes();
  page.clip(box);
  for (std::size_t k = 0; k < drawn.fits.size(); k++) {
    Line line;
    for (std::size_t i = 0; i < drawn.shells->b.size(); i++)
      line.push_back(place(drawn.shells->b[i], drawn.fits[k]->fit.predicted[i]));
    panel.line(line, rgb(palette[k % 4]), 1.0);
  }
  std::vector<Point> dots;
  for (std::size_t i = 0; i < drawn.shells->b.size(); i++)
    dots.push_back(place(drawn.shells->b[i], drawn.shells->signal[i]));
  panel.dots(dots, 3.0, black);
  page.unclip();
}

void draw_residuals(Page &page, const Box &box, const Drawn &drawn, const Axis &x) {
  double most = 1e-9;
  for (const Result *r : drawn.fits)
    for (std::size_t i = 0; i < drawn.shells->b.size(); i++)
      most = std::max(most, std::fabs(drawn.shells->signal[i] - r->fit.predicted[i]));
  most = round_up(most);
  Panel panel(page, box, x, {-most, most, "signal - fit"});
  panel.axes();
  panel.dashes({{x.low, 0.0}, {x.high, 0.0}}, black, 0.4);
  for (std::size_t k = 0; k < drawn.fits.size(); k++) {
    Line line;
    for (std::size_t i = 0; i < drawn.shells->b.size(); i++)
      line.push_back({drawn.shells->b[i], drawn.shells->signal[i] - drawn.fits[k]->fit.predicted[i]});
    panel.line(line, rgb(palette[k % 4]), 0.7), panel.dots(line, 2.5, rgb(palette[k % 4]));
  }
}

std::string draw(const Drawn &drawn) {
  Page page(width, height);
  const Shells &s = *drawn.shells;
  const std::vector<Box> boxes = columns({38.0, 30.0, width - 48.0, height - 62.0}, 3, 44.0);
  const Axis b{0.0, 1.03 * highest(s.b), "b [ms/um2]"};
  const double floor = 0.5 * std::floor(2.0 * log10_of(std::max(lowest(s.signal), 1e-4)));
  draw_panel(page, boxes[0], drawn, b, {floor, 0.0, "log10 signal"}, semilog);
  const double far = 1.03 / std::sqrt(lowest(s.b));
  draw_panel(page, boxes[1], drawn, {0.0, far, "1 / sqrt b [(um2/ms)^1/2]"},
             {0.0, round_up(highest(s.signal)), "signal"}, by_root);
  draw_residuals(page, boxes[2], drawn, b);
  page.text({8.0, 12.0}, drawn.fits[0]->signal, {8.0, black, Anchor::left, true, false});
  std::vector<Key> keys;
  for (std::size_t k = 0; k < drawn.fits.size(); k++) {
    const Result &r = *drawn.fits[k];
    keys.push_back(
        {model_name(r) + ", " + kernel_name(r) + ", D_in " + (r.fit.fitted[neurite_d] ? "free" : "held"),
         rgb(palette[k % 4])});
  }
  legend(page, {width - 8.0, 12.0}, keys, Anchor::right);
  return page.svg("SANDI: " + drawn.fits[0]->signal);
}

std::string file_name(std::string name) {
  for (char &c : name)
    if (!(c >= '0' && c <= '9') && !(c >= 'A' && c <= 'Z') && !(c >= 'a' && c <= 'z') && c != '-') c = '_';
  return name;
}

} // namespace

void check_pictures(const std::string &folder) {
  if (!folder.empty()) make_folder(folder);
}

void draw_pictures(const std::string &folder, const std::vector<Result> &results) {
  if (folder.empty()) return;
  for (std::size_t first = 0; first < results.size();) {
    Drawn drawn{&results[first].averages.shells, {}};
    std::size_t end = first;
    for (; end < results.size() && results[end].signal == results[first].signal; end++)
      drawn.fits.push_back(&results[end]);
    OutputFile file(folder + "/sandi-" + file_name(results[first].signal) + ".svg");
    file.write(draw(drawn)), file.commit();
    first = end;
  }
}

} // namespace conceg::fit
