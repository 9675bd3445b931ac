// SPDX-License-Identifier: BSD-3-Clause
// NIfTI-1 single files: labels, and the fraction of each larger voxel that lies in cells. mm, x fastest, the
// affine in the sform.
#include "job.hpp"

#include <cmath>
#include <cstring>

namespace conceg::exporting {
namespace {

#pragma pack(push, 1)
struct Nifti1 { // the 348 bytes of the standard, by its names
  std::int32_t sizeof_hdr;
  char unused1[35], dim_info;
  std::int16_t dim[8];
  float intent_p[3];
  std::int16_t intent_code, datatype, bitpix, slice_start;
  float pixdim[8], vox_offset, scl_slope, scl_inter;
  std::int16_t slice_end;
  char slice_code, xyzt_units;
  float cal_max, cal_min, slice_duration, toffset;
  std::int32_t unused2[2];
  char descrip[80], aux_file[24];
  std::int16_t qform_code, sform_code;
  float quatern[3], qoffset[3], srow[3][4];
  char intent_name[16], magic[4];
  char extension[4]; // four zero bytes: nothing follows before the voxels
};
#pragma pack(pop)
static_assert(sizeof(Nifti1) == 352, "348 bytes and the extension flag");

constexpr std::int16_t type_i32 = 8, type_f32 = 16, scanner = 1;
constexpr double mm_per_um = 1e-3;

void write_nifti(Job &job, const std::string &file, const glm::ivec3 &shape, const glm::dvec3 &origin_um,
                 const glm::dvec3 &spacing_um, std::int16_t type, const void *voxels, std::size_t bytes) {
  if (shape.x > 32767 || shape.y > 32767 || shape.z > 32767)
    fail(CONCEG_E_UNSUPPORTED, "nifti: at most 32767 voxels along an axis, got %d x %d x %d", shape.x,
         shape.y, shape.z);
  Nifti1 header = {};
  header.sizeof_hdr = 348;
  header.dim[0] = 3;
  header.pixdim[0] = 1.0f;
  for (int axis = 0; axis < 3; axis++) {
    header.dim[axis + 1] = static_cast<std::int16_t>(shape[axis]);
    header.pixdim[axis + 1] = static_cast<float>(spacing_um[axis] * mm_per_um);
    header.srow[axis][axis] = header.pixdim[axis + 1];
    header.srow[axis][3] = header.qoffset[axis] = static_cast<float>(origin_um[axis] * mm_per_um);
  }
  for (int axis = 4; axis < 8; axis++)
    header.dim[axis] = 1;
  header.datatype = type, header.bitpix = 32, header.vox_offset = 352.0f, header.scl_slope = 1.0f;
  header.xyzt_units = 2; // mm
  header.qform_code = header.sform_code = scanner;
  std::strcpy(header.descrip, "ConCeG");
  std::memcpy(header.magic, "n+1", 4);
  OutputFile output(job.folder.at(file));
  output.write(&header, sizeof header);
  output.write(voxels, bytes);
  output.commit();
  Written row;
  row.file = file, row.what = "volume";
  row.points = static_cast<std::uint64_t>(shape.x) * static_cast<std::uint64_t>(shape.y) *
               static_cast<std::uint64_t>(shape.z);
  job.folder.add(std::move(row));
}

} // namespace

void export_nifti(Job &job) {
  if (job.source.volume_bytes() > static_cast<double>(conceg_ctx_memory(job.ctx)))
    fail(CONCEG_E_NOMEM, "nifti: the labels need %.0f MB of memory; raise --memory",
         job.source.volume_bytes() * 1e-6);
  const Volume volume = job.source.volume();
  if (volume.label.empty())
    fail(CONCEG_E_MISSING,
         "/volumes/label: NIfTI maps need labels, got none; run the mesh stage with volumes first");
  write_nifti(job, "nifti/labels.nii", volume.shape, volume.origin, volume.spacing, type_i32,
              volume.label.data(), volume.label.size() * 4);

  // Each label voxel falls into the larger voxel that holds its centre; the larger ones divide the box
  // evenly.
  glm::ivec3 shape(1);
  glm::dvec3 spacing(0.0);
  for (int axis = 0; axis < 3; axis++) {
    const double length = volume.spacing[axis] * volume.shape[axis];
    shape[axis] =
        std::min(volume.shape[axis], std::max(1, static_cast<int>(length / job.options.fraction_um + 0.5)));
    spacing[axis] = length / shape[axis];
  }
  std::vector<float> inside(static_cast<std::size_t>(shape.x) * static_cast<std::size_t>(shape.y) *
                                static_cast<std::size_t>(shape.z),
                            0.0f),
      all = inside;
  std::size_t at = 0;
  for (int z = 0; z < volume.shape.z; z++)
    for (int y = 0; y < volume.shape.y; y++)
      for (int x = 0; x < volume.shape.x; x++, at++) {
        const glm::ivec3 i = glm::ivec3((glm::dvec3(x, y, z) + 0.5) * volume.spacing / spacing);
        const std::size_t to = (static_cast<std::size_t>(i.z) * static_cast<std::size_t>(shape.y) +
                                static_cast<std::size_t>(i.y)) *
                                   static_cast<std::size_t>(shape.x) +
                               static_cast<std::size_t>(i.x);
        all[to] += 1.0f, inside[to] += volume.label[at] != 0 ? 1.0f : 0.0f;
      }
  for (std::size_t i = 0; i < all.size(); i++)
    inside[i] /= all[i];
  write_nifti(job, "nifti/fraction.nii", shape, volume.origin + 0.5 * (spacing - volume.spacing), spacing,
              type_f32, inside.data(), inside.size() * 4);
}

} // namespace conceg::exporting
