// SPDX-License-Identifier: BSD-3-Clause
// The panels of figure.hpp.
#pragma once

#include "figure.hpp"
#include "plot.hpp"

namespace conceg::characterise {

// Colours that stay apart without the red-green channel.
plot::Colour neurite_colour(int neurite);
// A basal tree is called a dendrite where the entry has no apical one.
std::string neurite_name(int neurite, bool has_apical);
// Kinds in the order of the figure.
const std::vector<int> &neurite_order();

constexpr double text_size = 7.0, bold_size = 9.0; // few sizes: each brings its own outlines of letters

// The letter and the title above a panel whose upper left corner is at `corner`.
void head(plot::Page &page, const plot::Point &corner, char letter, const std::string &title);

void draw_barcode(plot::Page &page, const plot::Box &box, const std::vector<DrawnBar> &bars);
void draw_diagram(plot::Page &page, const plot::Box &box, const std::vector<DrawnDonor> &donors);

// Extent of a cell in its picture, um from the soma's centre.
struct Extent {
  double left = 0.0, right = 0.0, down = 0.0, up = 0.0;
};
Extent extent_of(const metrics::Samples &samples);
// The cell seen along y at `scale` pt per um, with its soma's centre at `soma`.
void draw_cell(plot::Page &page, const plot::Point &soma, double scale, const metrics::Samples &samples);

// Five densities side by side, with their means; what an entry lacks stays empty.
void draw_distributions(plot::Page &page, const plot::Box &box, const DrawnEntry &entry);

} // namespace conceg::characterise
