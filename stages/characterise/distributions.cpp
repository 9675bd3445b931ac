// SPDX-License-Identifier: BSD-3-Clause
// The distributions of figure.hpp: how branches of donors and of grown cells are made.
#include "measures.hpp"
#include "panels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

namespace conceg::characterise {
namespace {

constexpr double degrees = 57.29577951308232;
const plot::Colour donor_colour = plot::rgb(0x222222), single_colour = plot::rgb(0xC3C8CD),
                   grown_colour = plot::rgb(0x8B5BB5);

struct Quantity {
  std::vector<double> Measured::*values;
  const char *label, *unit;
  int decimals;
  bool counts;      // whole numbers: shares of branches as steps, in place of a density
  double low, high; // bounds that no value can pass; infinite = none
};
constexpr double endless = std::numeric_limits<double>::infinity();
const Quantity quantities[] = {{&Measured::length, "branch length (µm)", " µm", 1, false, 0.0, endless},
                               {&Measured::order, "branch order", "", 2, true, 0.5, endless},
                               {&Measured::straightness, "straightness", "", 3, false, -endless, 1.0},
                               {&Measured::angle, "fork angle (°)", "°", 1, false, 0.0, 180.0},
                               {&Measured::radius, "branch radius (µm)", " µm", 3, false, 0.0, endless}};

std::vector<double> pooled(const std::vector<Measured> &cells, std::vector<double> Measured::*values) {
  std::vector<double> out;
  for (const Measured &cell : cells)
    out.insert(out.end(), (cell.*values).begin(), (cell.*values).end());
  return out;
}

std::string mean_and_sd(const std::vector<double> &values, const Quantity &quantity) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values)
    sum += value;
  const auto n = static_cast<double>(values.size());
  for (const double value : values)
    squares += (value - sum / n) * (value - sum / n);
  char text[64];
  std::snprintf(text, sizeof text, "%.*f ± %.*f%s", quantity.decimals, sum / n, quantity.decimals,
                std::sqrt(squares / n), quantity.unit);
  return text;
}

// The axis ends at its bounds, or at round numbers that leave 1 % of the values out.
plot::Bounds range_of(const Quantity &quantity, const std::vector<double> &all) {
  plot::Bounds out{quantity.low, quantity.high, quantity.low > -endless, quantity.high < endless};
  if (quantity.counts) {
    out.high = std::max(2.0, plot::quantile(all, 1.0)) + 0.5;
  } else if (!out.closed_high) {
    const double end = std::max(1e-3, plot::quantile(all, 0.99)), step = plot::round_up(end / 10.0);
    out.high = step * std::ceil(end / step);
  } else if (!out.closed_low) {
    out.low = std::min(0.9, std::floor(plot::quantile(all, 0.01) * 10.0) / 10.0);
  }
  return out;
}

// One cell's kernels are wider than the pooled ones, as it has fewer values; the spread is that of `pool`.
plot::Line curve(const std::vector<double> &values, const std::vector<double> &pool, const Quantity &quantity,
                 const plot::Bounds &range) {
  if (values.empty()) return {};
  if (!quantity.counts) {
    const double finest =
        (range.high - range.low) / 100.0; // equal values are a spike, not a line of no width
    return plot::density(values, range, std::max(finest, plot::kernel_width(pool, values.size())));
  }
  const auto bins = static_cast<std::size_t>(range.high - range.low + 0.5);
  return plot::histogram(values, range.low, range.high, bins).steps();
}

double highest_of(const plot::Line &line) {
  double out = 0.0;
  for (const plot::Point &p : line)
    out = std::max(out, p.y);
  return out;
}

void draw_quantity(plot::Page &page, const plot::Box &box, const DrawnEntry &entry,
                   const Quantity &quantity) {
  const std::vector<double> donors = pooled(entry.donor_branches, quantity.values),
                            grown = pooled(entry.grown_branches, quantity.values);
  std::vector<double> all(donors);
  all.insert(all.end(), grown.begin(), grown.end());
  if (all.empty()) return;
  const plot::Bounds range = range_of(quantity, all);
  const plot::Line donor_curve = curve(donors, donors, quantity, range),
                   grown_curve = curve(grown, grown, quantity, range);
  std::vector<plot::Line> single;
  for (const Measured &cell : entry.donor_branches)
    if (entry.donor_branches.size() > 1)
      single.push_back(curve(cell.*quantity.values, donors, quantity, range));
  const double pooled_highest = std::max(highest_of(donor_curve), highest_of(grown_curve));
  double highest = pooled_highest;
  for (const plot::Line &line : single)
    highest = std::max(highest, std::min(1.5 * pooled_highest, highest_of(line)));
  plot::Panel panel(page, box, {range.low, range.high, quantity.label, 5},
                    {0.0, std::max(1e-9, 1.05 * highest), quantity.counts ? "share" : "density", 4, false});
  page.clip(box);
  for (const plot::Line &line : single)
    panel.line(line, single_colour, 0.4);
  panel.line(donor_curve, donor_colour, 1.2);
  panel.line(grown_curve, grown_colour, 1.2);
  page.unclip();
  panel.axes();
  const double middle = box.left + box.width / 2.0;
  const plot::TextStyle style{text_size, donor_colour, plot::Anchor::middle};
  plot::TextStyle other = style;
  other.colour = grown_colour;
  if (!donors.empty())
    page.text({middle, box.top - (entry.grown_branches.empty() ? 2.0 : 9.0)}, mean_and_sd(donors, quantity),
              style);
  if (!grown.empty()) page.text({middle, box.top - 1.0}, mean_and_sd(grown, quantity), other);
}

} // namespace

Measured measure_branches(const metrics::Samples &samples) {
  const metrics::Metrics all = metrics::measure(samples, sholl_step_um);
  const bool only_axon = std::all_of(all.sections.begin(), all.sections.end(),
                                     [](const metrics::Section &s) { return s.kind == neurite_axon; });
  Measured out;
  for (const metrics::Section &s : all.sections) {
    if (s.kind == neurite_axon && !only_axon) continue;
    out.length.push_back(s.length), out.order.push_back(s.order), out.radius.push_back(s.mean_radius);
    if (s.straightness_1um != metrics::none) out.straightness.push_back(s.straightness_1um);
    if (s.local_angle != metrics::none) out.angle.push_back(s.local_angle * degrees);
  }
  return out;
}

void draw_distributions(plot::Page &page, const plot::Box &box, const DrawnEntry &entry) {
  const std::vector<plot::Box> boxes = plot::columns(box, std::size(quantities), 20.0);
  for (std::size_t i = 0; i < boxes.size(); i++)
    draw_quantity(page, boxes[i], entry, quantities[i]);
  std::vector<plot::Key> keys;
  if (!entry.donor_branches.empty()) {
    keys.push_back({"donors, pooled", donor_colour, 1.1});
    if (entry.donor_branches.size() > 1) keys.push_back({"each donor", single_colour, 0.6});
  }
  if (!entry.grown_branches.empty())
    keys.push_back(
        {"grown cells, pooled (" + std::to_string(entry.grown_branches.size()) + ")", grown_colour, 1.1});
  plot::legend(page, {box.left + box.width, box.top - (entry.grown_branches.empty() ? 16.0 : 22.0)}, keys,
               plot::Anchor::right);
}

} // namespace conceg::characterise
