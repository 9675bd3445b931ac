// SPDX-License-Identifier: BSD-3-Clause
// --to vdb: /volumes as an OpenVDB file.
#include "job.hpp"
#include "vdb.hpp"
#include "view.hpp"

#include <algorithm>

namespace conceg::exporting {

void export_vdb(Job &job) {
  const View<double> origin = view<double>(job.doc, "/volumes@origin", 3),
                     spacing = view<double>(job.doc, "/volumes@spacing", 3);
  const View<std::int32_t> leaf = view<std::int32_t>(job.doc, "/volumes/leaf_origin", 3);
  View<std::uint32_t> label;
  View<float> distance;
  if (has(job.doc, "/volumes/label")) label = view<std::uint32_t>(job.doc, "/volumes/label", 512);
  if (has(job.doc, "/volumes/distance")) distance = view<float>(job.doc, "/volumes/distance", 512);
  if ((label.data() && label.rows() != leaf.rows()) || (distance.data() && distance.rows() != leaf.rows()))
    fail(CONCEG_E_FORMAT, "/volumes: expected %zu leaves in label and distance, got %zu and %zu", leaf.rows(),
         label.rows(), distance.rows());
  float band = 0.0f;
  for (const float d : distance)
    band = std::max(band, d);
  Written row;
  row.file = "vdb/volume.vdb", row.what = "volume", row.points = leaf.rows() * 512;
  write_vdb({{origin[0], origin[1], origin[2]},
             {spacing[0], spacing[1], spacing[2]},
             static_cast<double>(band),
             leaf.rows(),
             leaf.data(),
             label.data(),
             distance.data()},
            job.folder.at(row.file));
  job.folder.add(std::move(row));
}

} // namespace conceg::exporting
