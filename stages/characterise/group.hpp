// SPDX-License-Identifier: BSD-3-Clause
// Do the files of one entry agree?
#pragma once

#include "morphology.hpp"

#include <string>
#include <vector>

namespace conceg::characterise {

// Largest side of the box around the dendrites, or around all trees where there is no dendrite, um.
double extent_of(const Cell &cell);

struct FileExtent {
  std::string path;
  double extent_um;
};
// Throws an Error that names the file whose cell is 20 times larger or smaller than the entry's others (their
// median): its lengths are in other units (voxels, nm).
void check_units(const std::string &entry, const std::vector<FileExtent> &files);

} // namespace conceg::characterise
