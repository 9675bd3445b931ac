// SPDX-License-Identifier: BSD-3-Clause
// Signals of single directions -> direction averages over the signal at b = 0.
#pragma once

#include "sandi.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::fit {

// Rows of one timing; b in ms/um^2. `error`: standard errors, empty when unknown. `group`, `group_error`: the
// protocol's shell of each row, and the standard error of its average over directions, which counts walkers
// that the directions share; empty when unknown.
struct Measurements {
  std::vector<double> b, signal, error;
  std::vector<std::uint32_t> group;
  std::vector<double> group_error;
};

struct Averages {
  Shells shells;                      // b ascending, above 0
  double unweighted = 1.0;            // the mean signal at b = 0, before the division
  std::vector<std::uint64_t> members; // measurements of each shell
  std::vector<std::string> warnings;
};

// Values of b that lie within `width` of a neighbour are one shell; b up to `width` is b = 0. `what` names
// the signals in messages. Throws Error(E_FORMAT) for values that are not finite, b that is negative or in
// other units, and signals without b = 0. Where the rows of a shell are one group, its error is the group's;
// else their errors are taken as independent.
Averages average_shells(const Measurements &rows, double width, const std::string &what);

// Error(E_RANGE) when there are not as many shells as fitted parameters. `fitted` names them.
void check_shells(const Shells &shells, const std::vector<std::string> &fitted, const std::string &what);

// Error(E_MISSING) when a shell has no standard error to weight it by.
void check_errors(const Shells &shells, const std::string &what);

} // namespace conceg::fit
