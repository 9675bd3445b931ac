// SPDX-License-Identifier: BSD-3-Clause
#include "panels.hpp"

#include "morphology.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace conceg::characterise {
namespace {

const plot::Colour ink = plot::rgb(0x222222), faint = plot::rgb(0x9AA1A8), soma_colour = plot::rgb(0x333333);

double longest(const std::vector<DrawnBar> &bars) {
  double out = 1.0;
  for (const DrawnBar &bar : bars)
    out = std::max(out, bar.death);
  return out;
}

// Bars of one kind, by birth and then the longest first.
std::vector<DrawnBar> sorted_bars(const std::vector<DrawnBar> &bars, int neurite) {
  std::vector<DrawnBar> out;
  for (const DrawnBar &bar : bars)
    if (bar.neurite == neurite) out.push_back(bar);
  std::stable_sort(out.begin(), out.end(), [](const DrawnBar &a, const DrawnBar &b) {
    return std::tie(a.birth, b.death) < std::tie(b.birth, a.death);
  });
  return out;
}

constexpr double thinnest = 0.3, width_step = 0.1;

} // namespace

plot::Colour neurite_colour(int neurite) {
  switch (neurite) {
  case neurite_apical:
    return plot::rgb(0xD1401F);
  case neurite_basal:
    return plot::rgb(0x1F6FB5);
  case neurite_axon:
    return plot::rgb(0xC9A21B);
  default:
    return plot::rgb(0x1E9C73);
  }
}

std::string neurite_name(int neurite, bool has_apical) {
  switch (neurite) {
  case neurite_apical:
    return "apical dendrite";
  case neurite_basal:
    return has_apical ? "basal dendrite" : "dendrite";
  case neurite_axon:
    return "axon";
  default:
    return "glial process";
  }
}

const std::vector<int> &neurite_order() {
  static const std::vector<int> order{neurite_apical, neurite_basal, neurite_axon, neurite_glia};
  return order;
}

void head(plot::Page &page, const plot::Point &corner, char letter, const std::string &title) {
  page.text({corner.x, corner.y}, std::string(1, letter), {bold_size, ink, plot::Anchor::left, true});
  page.text({corner.x + 11.0, corner.y}, title, {text_size, ink});
}

void draw_barcode(plot::Page &page, const plot::Box &box, const std::vector<DrawnBar> &bars) {
  constexpr double gap = 4.0; // between kinds, in pt
  std::vector<std::vector<DrawnBar>> groups;
  for (const int neurite : neurite_order()) {
    groups.push_back(sorted_bars(bars, neurite));
    if (groups.back().empty()) groups.pop_back();
  }
  const double room = box.height - gap * static_cast<double>(groups.size() + 1),
               pitch = std::min(2.2 * bar_width, room / static_cast<double>(bars.size()));
  plot::Panel panel(page, box, {0.0, longest(bars) * 1.02, "path length (µm)", 7},
                    {0.0, 1.0, std::to_string(bars.size()) + " bars", 2, false});
  double y = box.top + gap;
  for (const std::vector<DrawnBar> &group : groups) {
    for (const DrawnBar &bar : group) {
      y += pitch;
      page.lines({{{panel.place(bar.birth, 0.0).x, y - pitch / 2.0},
                   {panel.place(bar.death, 0.0).x, y - pitch / 2.0}}},
                 neurite_colour(bar.neurite), std::min(bar_width, 0.75 * pitch));
    }
    y += gap;
  }
  panel.axes();
}

void draw_diagram(plot::Page &page, const plot::Box &box, const std::vector<DrawnDonor> &donors) {
  double high = 1.0;
  std::size_t count = 0;
  for (const DrawnDonor &donor : donors)
    high = std::max(high, longest(donor.bars)), count += donor.bars.size();
  high *= 1.02;
  plot::Panel panel(page, box, {0.0, high, "birth (µm)", 6}, {0.0, high, "death (µm)", 6});
  panel.dashes({{0.0, 0.0}, {high, high}}, faint, 0.5);
  const double diameter = count > 1500 ? 1.4 : count > 300 ? 1.8 : 2.6;
  for (auto neurite = neurite_order().rbegin(); neurite != neurite_order().rend(); ++neurite) {
    std::vector<plot::Point> points;
    for (const DrawnDonor &donor : donors)
      for (const DrawnBar &bar : donor.bars)
        if (bar.neurite == *neurite) points.push_back({bar.birth, bar.death});
    if (!points.empty()) panel.dots(points, diameter, neurite_colour(*neurite));
  }
  panel.axes();
}

Extent extent_of(const metrics::Samples &samples) {
  const double r = samples.soma_radius;
  Extent out{-r, r, -r, r};
  for (const glm::dvec3 &p : samples.position) {
    out.left = std::min(out.left, p.x), out.right = std::max(out.right, p.x);
    out.down = std::min(out.down, p.z), out.up = std::max(out.up, p.z);
  }
  return out;
}

void draw_cell(plot::Page &page, const plot::Point &soma, double scale, const metrics::Samples &samples) {
  using Pen = std::pair<int, int>; // kind, width in steps
  std::map<Pen, std::vector<plot::Line>> lines;
  std::vector<std::uint32_t> children(samples.size(), 0);
  for (const std::int64_t up : samples.parent)
    if (up >= 0) children[static_cast<std::size_t>(up)]++;
  const auto place = [&](std::size_t i) {
    return plot::Point{soma.x + scale * samples.position[i].x, soma.y - scale * samples.position[i].z};
  };
  const auto pen = [&](std::size_t i) {
    const double width = std::max(thinnest, 2.0 * samples.radius[i] * scale);
    return Pen{samples.kind[i], static_cast<int>(std::lround(width / width_step))};
  };
  // Where the line that ends with a sample lies among those of its pen.
  std::vector<std::size_t> line_of(samples.size(), 0);
  for (std::size_t i = 0; i < samples.size(); i++) {
    if (samples.parent[i] < 0) continue;
    const auto up = static_cast<std::size_t>(samples.parent[i]);
    std::vector<plot::Line> &own = lines[pen(i)];
    const bool goes_on = samples.parent[up] >= 0 && children[up] == 1 && pen(up) == pen(i);
    line_of[i] = goes_on ? line_of[up] : own.size();
    if (!goes_on) own.push_back({place(up)});
    own[line_of[i]].push_back(place(i));
  }
  for (auto neurite = neurite_order().rbegin(); neurite != neurite_order().rend(); ++neurite)
    for (const auto &[own, all] : lines)
      if (own.first == *neurite) page.lines(all, neurite_colour(own.first), width_step * own.second, true);
  page.disc(soma, std::max(0.8, scale * samples.soma_radius), soma_colour);
}

} // namespace conceg::characterise
