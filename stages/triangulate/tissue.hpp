// SPDX-License-Identifier: GPL-3.0-or-later
// What the network must know of the document's box, cells and bars. Lengths in um.
#pragma once

#include "levels.hpp"
#include "radius.hpp"

#include "conceg/doc.h"

#include <vector>

namespace conceg::triangulate {

// The box; its corners must lie on the lattice of geom.h.
conceg_box read_lattice_box(conceg_doc *doc);

std::vector<Soma> read_somas(conceg_doc *doc);

// Largest radius that any bar asks for: r(pl) = max(radius + taper (pl - (start + end) / 2), radius_floor).
double largest_target_um(conceg_doc *doc);

// Where a cell grows, and how thick its dendrites and processes are there; axons are left out, for they run
// anywhere. Cells without such bars are left out too.
struct Territory {
  glm::dvec3 center;     // of the soma
  double radius_um;      // mean distance of the attractors from the soma, weighted by the bars' lengths
  double mean_radius_um; // of its bars, weighted by their lengths
};
std::vector<Territory> read_territories(conceg_doc *doc, const std::vector<Soma> &somas);

// Compact territories whose processes are thin: level = the coarsest at which the node spacing
// `spacing_um` / 2^level is at most `radii` of their mean radii, but at most `finest`. A cell that reaches
// farther than `farthest_um` is left out: it is too sparse for the nodes that its whole range would take.
std::vector<Zone> thin_zones(const std::vector<Territory> &territories, double spacing_um, double radii,
                             double farthest_um, unsigned finest);

} // namespace conceg::triangulate
