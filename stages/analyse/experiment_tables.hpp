// SPDX-License-Identifier: BSD-3-Clause
// The tables of composition scaling, of power spectra, of blocks, of transport, of pores and of paths.
#pragma once

#include "composition.hpp"
#include "paths.hpp"
#include "spectrum.hpp"
#include "statistics_table.hpp"
#include "transport.hpp"

#include <string>

namespace conceg::analyse {

// `erosion`, um: how far the labels were drawn back from their membranes; 0 = not.
Table composition_table(const Composition &composition, double erosion);     // a row per length
Table composition_fit_table(const Composition &composition, double erosion); // a row per range

struct ClassSpectrum {
  std::string name;
  std::uint64_t tips; // paths looked at
  double spacing;     // um, of the skeleton's samples
  Spectrum spectrum;
};

Table spectrum_table(const std::vector<ClassSpectrum> &spectra);     // a row per class and q
Table spectrum_fit_table(const std::vector<ClassSpectrum> &spectra); // a row per class

// What a row of the tables below was measured in.
struct Source {
  std::uint64_t block; // 0 = the whole box
  double ecs_fraction;
  double erosion, voxel; // um
};

// A row per block; `valid`: its voxels are small enough for the analyses.
void add_block(Table &table, std::uint64_t block, const glm::dvec3 &lo, double side, const OpenVoxels &voxels,
               double median, const OpenPieces &pieces, bool valid);

// A row per size of voxel (2 `voxel`, `voxel`), and the extrapolation to 0.
void add_transport(Table &table, std::uint64_t block, const Transport &coarse, const Transport &fine,
                   double voxel);

// A row per definition.
void add_pores(Table &table, const Source &source, std::uint64_t dimensions, const PoreSpace &pores);

// A row per way of going.
void add_paths(Table &table, const Source &source, std::uint64_t dimensions, double least,
               const PathStraightness &paths);

} // namespace conceg::analyse
