// SPDX-License-Identifier: BSD-3-Clause
// What figures are made of: ticks, lines, histograms, densities, and the page as SVG.
#include "plot.hpp"

#include "check.h"

#include <cmath>

using namespace conceg::plot;

namespace {

void check_numbers() {
  const std::vector<double> ticks = round_ticks(-0.3, 1.04, 5);
  CHECK_EQUAL(ticks.size(), 3);
  CHECK(ticks.size() == 3 && std::fabs(ticks[0]) < 1e-12 && ticks[1] == 0.5 && ticks[2] == 1.0);
  for (const double high : {0.07, 3.0, 645.0, 99999.0})
    for (const unsigned most : {2u, 4u, 7u}) {
      const std::size_t count = round_ticks(0.0, high, most).size();
      CHECK(count >= 1 && count <= most);
    }
  CHECK_NEAR(round_up(0.021), 0.05, 1e-12);
  CHECK_NEAR(round_up(20.0), 20.0, 1e-12);
  CHECK_NEAR(round_up(51.0), 100.0, 1e-12);
  CHECK_NEAR(round_down(99.0), 50.0, 1e-12);
  CHECK_NEAR(round_down(0.2), 0.2, 1e-12);
  CHECK_NEAR(round_down(1.9), 1.0, 1e-12);
  CHECK_EQUAL(quantile({3, 1, 2}, 0.5), 2);
  CHECK_EQUAL(quantile({3, 1, 2}, 1.0), 3);
}

void check_lines() {
  const Line bent{{0, 0}, {1, 0.01}, {2, 0}, {3, 1}, {2, 0}};
  const Line out = simplified(bent, 0.05);
  CHECK_EQUAL(out.size(), 4); // the small bend goes, the turn back stays
  CHECK(out.size() == 4 && out[1].x == 2 && out[2].x == 3 && out[3].x == 2);
  CHECK_EQUAL(simplified(bent, 0.001).size(), 5);
  const std::vector<Box> boxes = columns({10, 0, 100, 5}, 3, 5);
  CHECK_NEAR(boxes[2].left + boxes[2].width, 110.0, 1e-9);
  CHECK_NEAR(boxes[1].left - boxes[0].left, 35.0, 1e-9);
}

void check_distributions() {
  const Histogram shares = histogram({0.0, 0.5, 1.0, 7.0}, 0.0, 1.0, 2);
  CHECK_NEAR(shares.share[0], 0.25, 1e-12);
  CHECK_NEAR(shares.share[1], 0.5, 1e-12); // the upper end belongs to the last bin, 7 to none
  CHECK_EQUAL(shares.steps().size(), 6);
  CHECK_NEAR(shares.steps()[3].x, 0.5, 1e-12);

  std::vector<double> values;
  for (int i = 0; i < 200; i++)
    values.push_back(0.005 * (i + 0.5)); // even between the bounds
  const double width = kernel_width(values, values.size());
  CHECK_NEAR(width, 0.9 * 0.2887 * std::pow(200.0, -0.2), 5e-3);
  const Line even = density(values, {0.0, 1.0, true, true}, width), open = density(values, {0.0, 1.0}, width);
  double integral = 0.0;
  for (std::size_t i = 1; i < even.size(); i++)
    integral += (even[i].x - even[i - 1].x) * (even[i].y + even[i - 1].y) / 2.0;
  CHECK_NEAR(integral, 1.0, 2e-3);
  CHECK_NEAR(even.front().y, 1.0, 0.02);
  CHECK_NEAR(open.front().y, 0.5, 0.05); // without the bound half of the kernels lie outside
}

std::string draw() {
  Page page(100, 50);
  page.lines({{{0, 10}, {50, 10.01}, {100, 10}}}, rgb(0xFF0000), 0.7);
  page.text({5, 40}, "µm ± <", {});
  Panel(page, {20, 5, 70, 30}, {0, 1, "x", 3}, {0, 1, "y", 3}).axes();
  return page.svg("a < b & c");
}

void check_page() {
  const std::string svg = draw();
  CHECK(svg.find("<title>a &lt; b &amp; c</title>") != std::string::npos);
  CHECK(svg.find("stroke-width:0.7;") != std::string::npos);
  CHECK(svg.find("M 0 10 L 100 10") != std::string::npos);
  CHECK(svg == draw()); // no counter of the process in it
}

} // namespace

int main() {
  check_numbers();
  check_lines();
  check_distributions();
  check_page();
  return check_done();
}
