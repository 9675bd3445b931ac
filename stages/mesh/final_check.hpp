// SPDX-License-Identifier: BSD-3-Clause
// The last look at a document's /meshes. It reads the document and nothing else: neither the mesher's fields,
// nor its surfaces, nor what it found on the way count here.
#pragma once

#include "check.hpp"

#include "conceg/doc.h"

namespace conceg::mesh {

struct FinalCheck {
  Views surfaces;                     // of the document's rows, borrowed from it
  CheckResult result;                 // every pair of faces, in all images
  std::vector<std::uint32_t> missing; // cells without a surface
  std::vector<std::string> broken;    // what keeps the arrays from being read as surfaces, one line each
  // Everything that is wrong, in words, missing cells too; at most `most` lines.
  std::vector<std::string> lines(std::size_t most) const;
};

// `least_gap` (um): pairs of cells or images that are nearer are defects. Gaps are measured up to `reach`.
// Surfaces of form `closed` and level 0 alone are looked at.
FinalCheck check_document(conceg_doc *doc, double least_gap, double reach, std::size_t memory,
                          Workers &workers, const Progress &progress);

} // namespace conceg::mesh
