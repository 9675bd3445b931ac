// SPDX-License-Identifier: BSD-3-Clause
// Diffusion signals of a scanner or of another simulator -> plain arrays.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace conceg::importing {

struct SignalOptions {
  std::string bval, bvec;                                    // FSL files; empty = a table with a column b
  std::string compartment;                                   // of rows that do not name one
  double pulse_duration_ms = 0.0, pulse_separation_ms = 0.0; // of rows that do not give them; 0 = unknown
};

// One value per measurement; b in ms/um^2, times in ms, directions of length 1.
struct SignalSet {
  std::vector<double> b, direction, duration, separation; // direction: three each
  std::vector<std::string> compartment;
  std::vector<double> signal, error; // compartments x measurements; error 0 = unknown
};

// A comma-separated table, or a text of numbers with FSL's bval and bvec. E_FORMAT names file and line.
SignalSet read_signal_table(const std::string &path, const SignalOptions &options);
SignalSet read_signal_fsl(const std::string &path, const SignalOptions &options);

} // namespace conceg::importing
