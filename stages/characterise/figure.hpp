// SPDX-License-Identifier: BSD-3-Clause
// The figure of one entry of the dictionary: barcode, persistence diagram, morphology, distributions.
#pragma once

#include "metrics.hpp"

#include <string>
#include <vector>

namespace conceg::characterise {

struct DrawnBar {
  int neurite = 0; // SWC code of its tree
  double birth = 0.0, death = 0.0;
};

// A cell in the frame in which it is drawn, its soma's centre at 0.
struct DrawnCell {
  std::string title;
  bool pia_up = false; // +z is the pia
  metrics::Samples samples;
};

struct DrawnDonor {
  std::string id;
  std::vector<DrawnBar> bars;
  DrawnCell cell; // without samples for donors that were made of barcodes
};

// What the distributions take from one cell: a value per branch, per fork for the angle.
struct Measured {
  std::vector<double> length, order, straightness, angle, radius;
};
// Dendrites and glia; the axon only of cells that have nothing else.
Measured measure_branches(const metrics::Samples &samples);

struct DrawnEntry {
  std::string name, cell_class;
  std::vector<DrawnDonor> donors;
  std::size_t typical = 0; // row of the donor whose bars and morphology are drawn
  bool compared = false;   // there are grown cells to compare with, though this entry may have none
  DrawnCell grown;         // of the typical donor, or of another one of the entry
  std::vector<Measured> donor_branches, grown_branches; // per cell
};

// Width of a line of the barcode, where the panel has room for it.
constexpr double bar_width = 1.9;

// The figure as an SVG file.
std::string draw_entry(const DrawnEntry &entry);

} // namespace conceg::characterise
