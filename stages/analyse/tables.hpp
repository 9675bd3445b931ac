// SPDX-License-Identifier: BSD-3-Clause
// The measures put together as tables.
#pragma once

#include "bars.hpp"
#include "cable.hpp"
#include "field.hpp"
#include "morphometry.hpp"
#include "points.hpp"
#include "pores.hpp"
#include "statistics_table.hpp"
#include "volumes.hpp"

namespace conceg::analyse {

// Everything that was measured; an empty vector (or a measure with nothing in it) was left out.
struct Measures {
  double box_volume = 0;        // um3
  std::vector<Size> sizes;      // per cell, of its surfaces
  std::vector<CellCable> cable; // per cell
  std::vector<BarCount> bars;   // per cell
  Morphometry shape;            // apical is empty without a skeleton
  FieldShares field;            // voxels 0: not measured
  double field_step = 0;        // um
  PointShare points;            // points 0: not measured
  Pores pores;                  // voxels 0: not measured
};

// Classes in the order in which the types bring them, each once.
std::vector<std::string> classes_of(const Cells &cells);

// Volume fraction by the meshes; 0 without meshes.
double mesh_fraction(const Measures &measures);
// Largest difference between those of the three measures that there are; 0 with one alone.
double largest_difference(const Measures &measures);

Table summary_table(const Cells &cells, const Measures &measures);
Table class_table(const Cells &cells, const Measures &measures);
Table type_table(const Cells &cells, const Measures &measures);
Table cell_table(const Cells &cells, const Measures &measures);
Table neurite_table(const Cells &cells, const Measures &measures);
Table bars_table(const Cells &cells, const Measures &measures);
Table morphometry_table(const Cells &cells, const Measures &measures);

} // namespace conceg::analyse
