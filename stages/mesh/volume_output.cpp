// SPDX-License-Identifier: BSD-3-Clause
#include "volume_output.hpp"

#include "view.hpp"

namespace conceg::mesh {
namespace {

template <class T> T *new_leaves(conceg_doc *doc, const char *path, std::size_t leaves) {
  const std::uint64_t shape[2] = {leaves, kLeafVoxels};
  void *storage = nullptr;
  must(conceg_doc_new_array(doc, path, dtype_of<T>::value, 2, shape, &storage));
  return static_cast<T *>(storage);
}

} // namespace

VolumeOutput::VolumeOutput(conceg_ctx *ctx, const conceg_params *params, const Tissue &tissue,
                           const SceneOptions &options, Workers &workers)
    : in_document_(conceg_params_bool(params, "volumes") != 0), vdb_(conceg_params_text(params, "vdb")) {
  if (!in_document_ && vdb_.empty()) return;
  voxels_ = options;
  const double step = conceg_params_f64(params, "volume_step_um");
  voxels_.h = step > 0 ? step : 2 * options.h;
  layout_ = lay_out_volume(tissue, voxels_, workers, progress_of(ctx));
  check_size(ctx);
}

void VolumeOutput::leave_out(conceg_ctx *ctx, const Tissue &tissue, const std::vector<std::uint8_t> &left_out,
                             Workers &workers) {
  if ((!in_document_ && vdb_.empty()) || left_out.empty()) return;
  Relabelled divided = with_left_out_apart(tissue, left_out);
  layout_ = lay_out_volume(divided.tissue, voxels_, workers, progress_of(ctx), std::move(divided.label));
  check_size(ctx);
}

// A .vdb holds everything once more while it is written.
void VolumeOutput::check_size(conceg_ctx *ctx) const {
  const double value = sizeof(std::uint32_t) + sizeof(float),
               bytes = (vdb_.empty() ? 1.0 : 2.0) * value * static_cast<double>(layout_.values()),
               memory = static_cast<double>(conceg_ctx_memory(ctx));
  if (bytes > memory)
    fail(CONCEG_E_NOMEM,
         "volume_step_um: voxels of %.3f um take %.3f GB in %zu leaves, more than the %.3f GB of --memory; "
         "give larger voxels, or volumes=false",
         layout_.scene.grid.unit, 1e-9 * bytes, layout_.leaf_origin.size(), 1e-9 * memory);
}

void VolumeOutput::write(conceg_ctx *ctx, conceg_doc *doc, Workers &workers) const {
  if (!in_document_ && vdb_.empty()) return;
  std::vector<std::uint32_t> own_label;
  std::vector<float> own_distance;
  std::uint32_t *label;
  float *distance;
  if (in_document_) {
    const glm::ivec3 &voxels = layout_.shape();
    const std::uint64_t shape[3] = {std::uint64_t(voxels.x), std::uint64_t(voxels.y),
                                    std::uint64_t(voxels.z)};
    put(doc, "/volumes@origin", &layout_.origin().x, 3);
    put(doc, "/volumes@spacing", &layout_.spacing().x, 3);
    put(doc, "/volumes@shape", shape, 3);
    put3(doc, "/volumes/leaf_origin", layout_.leaf_origin);
    label = new_leaves<std::uint32_t>(doc, "/volumes/label", layout_.leaf_origin.size());
    distance = new_leaves<float>(doc, "/volumes/distance", layout_.leaf_origin.size());
  } else {
    own_label.resize(layout_.values()), own_distance.resize(layout_.values());
    label = own_label.data(), distance = own_distance.data();
  }
  fill_volume(layout_, label, distance, workers, progress_of(ctx));
  if (!vdb_.empty()) write_vdb(leaves(layout_, label, distance), vdb_);
  workers.count(ctx, "mesh.volume");
}

} // namespace conceg::mesh
