// SPDX-License-Identifier: BSD-3-Clause
// Signals as files: tables, NIfTI with bval and bvec, a figure.
#pragma once

#include "signals.hpp"

#include <string>
#include <vector>

namespace conceg::simulate {

struct Results {
  std::vector<Compartment> compartment;
  std::vector<Signals> signals;            // of each
  std::vector<double> time;                // ms
  std::vector<std::vector<Spread>> spread; // [compartments][times]
};

// signals.csv, powder.csv, and displacements.csv when there are times.
void write_csv(const std::string &folder, const Protocol &protocol, const Results &results);
// signals.nii (float32, compartments along x, measurements along t), signals.bval (s/mm^2), signals.bvec and
// signals.txt, which names the compartments.
void write_nifti(const std::string &folder, const Protocol &protocol, const Results &results);
// signals.svg: direction averages over b, logarithmic, and against 1 / sqrt(b).
void write_figure(const std::string &folder, const Protocol &protocol, const Results &results);

} // namespace conceg::simulate
