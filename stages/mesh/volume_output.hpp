// SPDX-License-Identifier: BSD-3-Clause
// /volumes and the .vdb of the stage: laid out and held against --memory before the long work, written after
// it.
#pragma once

#include "conceg/conceg.h"
#include "left_out.hpp"
#include "volume.hpp"

namespace conceg::mesh {

class VolumeOutput {
public:
  // What `volumes`, `volume_step_um` and `vdb` ask for. Throws E_NOMEM when it does not fit.
  VolumeOutput(conceg_ctx *ctx, const conceg_params *params, const Tissue &tissue,
               const SceneOptions &options, Workers &workers);
  // Lays the volume out again without the pieces that the meshes leave out.
  void leave_out(conceg_ctx *ctx, const Tissue &tissue, const std::vector<std::uint8_t> &left_out,
                 Workers &workers);
  void write(conceg_ctx *ctx, conceg_doc *doc, Workers &workers) const;

private:
  void check_size(conceg_ctx *ctx) const;
  bool in_document_;
  std::string vdb_; // empty: no file
  SceneOptions voxels_;
  VolumeLayout layout_;
};

} // namespace conceg::mesh
