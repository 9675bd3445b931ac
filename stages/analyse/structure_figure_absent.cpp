// SPDX-License-Identifier: BSD-3-Clause
// Stands in for structure_figure.cpp in a build without Cairo.
#include "structure_report.hpp"

namespace conceg::analyse {

void draw_structure(const std::string &, const std::vector<StructureResult> &) {}

} // namespace conceg::analyse
