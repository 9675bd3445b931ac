// SPDX-License-Identifier: BSD-3-Clause
// A volume of labels -> a document: a cell per label, its voxels in /volumes.
#pragma once

#include "npy.hpp"
#include "scene.hpp"

namespace conceg::importing {

struct LabelOptions {
  std::array<double, 3> voxel_um; // along x, y, z
  double resample_um;             // side of the document's voxels; 0 = those of the file
  bool reversed_axes;             // the file's axes are z, y, x
};

// "0.016,0.016,0.04", or one size for all axes; E_PARAM otherwise.
std::array<double, 3> parse_voxel_um(const std::string &text);

// /domain (open on all sides), /types, /cells (id = label, place = middle of its voxels, no soma), /volumes
// without distances. A voxel of another size takes the label of the file's voxel that its centre lies in;
// what is left of a box that they do not fill is cut off at its upper faces.
void write_labels(conceg_ctx *ctx, conceg_doc *doc, const NpyArray &array, const LabelOptions &options);

} // namespace conceg::importing
