// SPDX-License-Identifier: BSD-3-Clause
// RMS (NYU): labels of voxels as text, x slowest, and what its program reads beside them, in a folder for the
// water in cells and one for the water between them. A label is an index into the tables of compartments;
// walkers start where it is not 0 and never enter 0, but cross freely between two labels above 0 (with the
// probability sqrt(D2 / D1)): the other water must be 0. At the sides of its box it mirrors.
#include "simulation.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::exporting {
namespace {

// 1 where the water is, 0 elsewhere.
template <class HasWater>
void write_labels(Job &job, const Volume &volume, const std::string &name, HasWater has_water) {
  OutputFile fiber(job.folder.at(name));
  std::string line;
  for (int x = 0; x < volume.shape.x; x++)
    for (int y = 0; y < volume.shape.y; y++) {
      line.clear();
      for (int z = 0; z < volume.shape.z; z++) {
        const std::uint32_t label =
            volume.label[(static_cast<std::size_t>(z) * static_cast<std::size_t>(volume.shape.y) +
                          static_cast<std::size_t>(y)) *
                             static_cast<std::size_t>(volume.shape.x) +
                         static_cast<std::size_t>(x)];
        line += has_water(label) ? "1 " : "0 ";
      }
      fiber.write(line + "\n");
    }
  fiber.commit();
  Written row;
  row.file = name, row.what = "volume", row.points = volume.label.size();
  job.folder.add(std::move(row));
}

} // namespace

void export_rms(Job &job) {
  if (job.source.volume_bytes() > static_cast<double>(conceg_ctx_memory(job.ctx)))
    fail(CONCEG_E_NOMEM, "rms: the labels need %.0f MB of memory; raise --memory",
         job.source.volume_bytes() * 1e-6);
  const Volume volume = job.source.volume();
  if (volume.label.empty())
    fail(CONCEG_E_MISSING,
         "/volumes/label: RMS files need labels, got none; run the mesh stage with volumes first");
  const double step = volume.spacing.x;
  if (std::max(std::fabs(volume.spacing.y - step), std::fabs(volume.spacing.z - step)) > 1e-6 * step)
    fail(CONCEG_E_UNSUPPORTED, "/volumes@spacing: RMS takes cubic voxels alone, got %g x %g x %g um",
         volume.spacing.x, volume.spacing.y, volume.spacing.z);
  std::vector<bool> chosen(conceg_substrate_cells(job.source.substrate()) + 1, false);
  for (const Cell &cell : job.cells)
    chosen[cell.row + 1] = true;
  write_labels(job, volume, "rms/intra/fiber.txt",
               [&](std::uint32_t label) { return label && label < chosen.size() && chosen[label]; });
  write_labels(job, volume, "rms/extra/fiber.txt", [](std::uint32_t label) { return label == 0; });

  // A step must stay below a voxel: sqrt(6 D dt) <= 0.5 voxel.
  const Protocol &protocol = job.options.protocol;
  // The program stores 1000 signals, one every steps / 1000.
  const double longest = std::min(1e-3, 0.25 * step * step / (6.0 * job.options.diffusivity)),
               duration = protocol.separation_ms + protocol.pulse_ms,
               steps = 1000.0 * std::ceil(duration / longest / 1000.0 - 1e-9), dt = duration / steps;
  const std::vector<Measurement> rows = measurements(protocol);
  std::string b, directions;
  char text[256];
  for (const Measurement &m : rows) {
    std::snprintf(text, sizeof text, "%.8f\n", m.b), b += text;
    std::snprintf(text, sizeof text, "%.8f\n%.8f\n%.8f\n", m.direction.x, m.direction.y, m.direction.z),
        directions += text;
  }
  std::snprintf(text, sizeof text, "%.9e\n%.0f\n%llu\n%zu\n2\n%.9e\n%d\n%d\n%d\n", dt, steps,
                static_cast<unsigned long long>(job.options.walkers), rows.size(), step, volume.shape.x,
                volume.shape.y, volume.shape.z);
  const std::string configuration = text;
  std::snprintf(text, sizeof text, "%.8f\n%.8f\n", job.options.diffusivity, job.options.diffusivity);
  const std::string diffusivity = text;
  for (const std::string folder : {"rms/intra/", "rms/extra/"}) {
    job.text_file(folder + "simParamInput.txt", "configuration", configuration);
    job.text_file(folder + "bval.txt", "protocol", b);
    job.text_file(folder + "bvec.txt", "protocol", directions);
    job.text_file(folder + "diffusivity.txt", "configuration", diffusivity);
    job.text_file(folder + "T2.txt", "configuration", "80.00000000\n80.00000000\n");
  }
}

} // namespace conceg::exporting
