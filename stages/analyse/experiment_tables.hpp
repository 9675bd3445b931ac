// SPDX-License-Identifier: BSD-3-Clause
// The tables of composition scaling, of power spectra, of transport and of pores.
#pragma once

#include "composition.hpp"
#include "pore_space.hpp"
#include "spectrum.hpp"
#include "statistics_table.hpp"

#include <string>

namespace conceg::analyse {

Table composition_table(const Composition &composition);     // a row per length
Table composition_fit_table(const Composition &composition); // a row per range

struct ClassSpectrum {
  std::string name;
  std::uint64_t tips; // paths looked at
  double spacing;     // um, of the skeleton's samples
  Spectrum spectrum;
};

Table spectrum_table(const std::vector<ClassSpectrum> &spectra);     // a row per class and q
Table spectrum_fit_table(const std::vector<ClassSpectrum> &spectra); // a row per class

// A row per size of voxel, and the extrapolation to 0.
Table transport_table(const Transport &coarse, double coarse_um, const Transport &fine, double fine_um);

// A row per definition, in space and in sections across z.
Table pore_table(const PoreSpace &space, const PoreSpace &sections);

} // namespace conceg::analyse
