// SPDX-License-Identifier: BSD-3-Clause
// The figure of the signals.
#include "files.hpp"

#include "output.hpp"
#include "plot.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::simulate {

namespace {

constexpr std::uint32_t colours[] = {0x222222, 0xc0392b, 0x2471a3, 0xd68910, 0x1e8449,
                                     0x7d3c98, 0x0e6655, 0x935116, 0x5d6d7e, 0xa93226};

struct Curve {
  std::string name;
  std::vector<plot::Point> point; // b, signal; b > 0
};

std::vector<Curve> curves(const Protocol &p, const Results &r) {
  const std::vector<std::uint32_t> shell = shells(p);
  std::vector<Curve> out;
  for (std::size_t c = 0; c < r.compartment.size(); c++) {
    Curve curve{r.compartment[c].name, {}};
    for (std::size_t i = 0; i < r.signals[c].powder.size(); i++) {
      const std::size_t m =
          static_cast<std::size_t>(std::find(shell.begin(), shell.end(), i) - shell.begin());
      const Mean &s = r.signals[c].powder[i];
      if (s.value > 2.0 * s.error && s.value > 1e-4) curve.point.push_back({p.b[m], s.value});
    }
    std::sort(curve.point.begin(), curve.point.end(),
              [](const plot::Point &a, const plot::Point &b) { return a.x < b.x; });
    out.push_back(std::move(curve));
  }
  return out;
}

} // namespace

void write_figure(const std::string &folder, const Protocol &p, const Results &r) {
  make_folder(folder);
  const std::vector<Curve> all = curves(p, r);
  double most_b = 0.0, least = 1.0, most_root = 0.0;
  for (const Curve &c : all)
    for (const plot::Point &at : c.point) {
      most_b = std::max(most_b, at.x), least = std::min(least, at.y);
      if (at.x >= 1.0) most_root = std::max(most_root, 1.0 / std::sqrt(at.x));
    }
  if (!(most_b > 0.0))
    fail(CONCEG_E_RANGE, "pictures: expected a signal above its noise at some b above 0, got none");
  if (!(most_root > 0.0)) most_root = 1.0;
  plot::Page page(470.0, 240.0);
  const std::vector<plot::Box> boxes = plot::columns({45.0, 25.0, 410.0, 150.0}, 2, 50.0);
  plot::Panel logs(page, boxes[0], {0.0, most_b * 1.02, "b (ms/um2)", 6, true},
                   {std::floor(std::log10(least)), 0.05, "log10 of the signal", 5, true});
  plot::Panel roots(page, boxes[1], {0.0, most_root * 1.05, "1 / sqrt(b) (um/ms^1/2)", 6, true},
                    {0.0, 1.0, "signal", 6, true});
  logs.axes(), roots.axes();
  page.text({boxes[0].left, 15.0}, "Mean over directions", {8.0, {}, plot::Anchor::left, true, false});
  page.text({boxes[1].left, 15.0}, "b of 1 ms/um2 and above", {8.0, {}, plot::Anchor::left, true, false});
  std::vector<plot::Key> keys;
  for (std::size_t c = 0; c < all.size(); c++) {
    const plot::Colour colour = plot::rgb(colours[c % (sizeof colours / sizeof *colours)]);
    plot::Line low, high;
    for (const plot::Point &at : all[c].point) {
      low.push_back({at.x, std::log10(at.y)});
      if (at.x >= 1.0) high.push_back({1.0 / std::sqrt(at.x), at.y});
    }
    logs.line(low, colour, 1.0), roots.line(high, colour, 1.0);
    logs.dots(low, 2.5, colour), roots.dots(high, 2.5, colour);
    keys.push_back({all[c].name, colour, 2.0});
  }
  for (std::size_t at = 0; at < keys.size(); at += 4)
    plot::legend(page, {45.0, 215.0 + 9.0 * static_cast<double>(at / 4)},
                 {keys.begin() + static_cast<std::ptrdiff_t>(at),
                  keys.begin() + static_cast<std::ptrdiff_t>(std::min(keys.size(), at + 4))},
                 plot::Anchor::left);
  OutputFile file(folder + "/signals.svg");
  file.write(page.svg("Diffusion signal by compartment"));
  file.commit();
}

} // namespace conceg::simulate
