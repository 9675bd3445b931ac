// SPDX-License-Identifier: BSD-3-Clause
// Power spectrum of the cross-section along neurites (the paper's section on structural validation, after
// Abdollahzadeh et al. 2025): a plateau at small q is short-range disorder, which sets how D(t) ends.
#pragma once

#include "parallel.hpp"
#include "tissue.hpp"

#include <vector>

namespace conceg::analyse {

struct SpectrumSettings {
  double skip = 10;                  // um of path from the soma that are left out
  double length = 100;               // um of path that are looked at; shorter paths are left out
  double step = 0.1;                 // um, of the samples
  double low_q = 0.06, high_q = 0.6; // rad/um, where exponent and plateau are taken
  int bootstraps = 200;
  std::uint64_t seed = 1;
};

// Cross-section pi r^2 along one path, each `step`.
struct AreaProfile {
  std::uint32_t cell;
  std::vector<double> area; // um2
};

struct AreaPaths {
  std::vector<AreaProfile> profiles;
  std::uint64_t tips = 0; // paths looked at, the short ones included
  double spacing = 0; // um between samples of the skeleton, mean over the paths; nothing is known below it
};

// Every path from a root to a tip of the chosen cells, axons left out unless `axons`. Paths of one cell share
// their beginnings.
AreaPaths area_paths(const Skeletons &skeletons, const std::vector<std::uint32_t> &cells, bool axons,
                     const SpectrumSettings &settings);

// Mean over the paths of |eta_q|^2 / L with eta = ln(A / <A>), at q = 2 pi k / L, k = 1, 2, .. below the
// Nyquist frequency of the skeleton's samples; bands are 2.5 and 97.5 % of a bootstrap over cells.
struct Spectrum {
  std::vector<double> q;                      // rad/um
  std::vector<double> raw, raw_low, raw_high; // um; mean of eta taken away
  std::vector<double> power, power_low,
      power_high;                        // um; its line taken away, which taper is: it adds g^2 L / q^2
  double raw_exponent = 0, exponent = 0; // slopes of ln(power) on ln(q) between low_q and high_q, k >= 3
  double plateau = 0;                    // um, mean of `power` there
  double reciprocal_plateau = 0; // um, the same of w = (1/A) / <1/A> - 1: the one that sets D(t) exactly
  double diffusivity_ratio = 0;  // D_infinity / D_0 = 1 / (<A> <1/A>), mean over the paths
  std::uint64_t paths = 0, cells = 0;
};

// Empty (paths 0) without profiles. All profiles have the same number of samples.
Spectrum spectrum_of(const AreaPaths &paths, const SpectrumSettings &settings, Workers &workers);

// |sum eta e^{-iqx} step|^2 / L at q = 2 pi k / L, k = 1 .. n / 2, of n samples.
std::vector<double> power_of(const std::vector<double> &eta, double step);

} // namespace conceg::analyse
