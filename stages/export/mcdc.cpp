// SPDX-License-Identifier: BSD-3-Clause
// MC/DC: text PLY in um with ply_scale to its mm, one per cell so that a walker tests its own cell alone, and
// one of all. Every triangle image that meets the voxel is there, since it wraps walkers but not triangles.
// Starting points lie strictly inside the voxel.
#include "simulation.hpp"

namespace conceg::exporting {
namespace {

std::string conf_text(const Job &job, const SimulationBox &box, const std::string &where, std::size_t walkers,
                      const std::vector<std::string> &files) {
  const Protocol &protocol = job.options.protocol;
  std::string text = "N " + std::to_string(walkers) + "\nT " +
                     std::to_string(static_cast<long>(protocol.echo_ms() * 1000.0 + 0.5)) + "\nduration " +
                     number_text(protocol.echo_ms() * 1e-3) + "\ndiffusivity " +
                     number_text(job.options.diffusivity * 1e-9) + "\nexp_prefix " + where +
                     "\nscheme_file protocol.scheme\nscale_from_stu 1\nwrite_txt 1\nwrite_bin "
                     "0\nwrite_traj_file 0\nini_walkers_file walkers_" +
                     where + "_mm.txt\n";
  for (const std::string &file : files)
    text += "<obstacle>\nply " + file + "\nply_scale 0.001\n</obstacle>\n";
  return text + "<voxels>\n0.0 0.0 0.0\n" + triple_text(box.sides * 1e-3, " ") +
         "\n</voxels>\nnum_process 1\nseed " + std::to_string(conceg_ctx_seed(job.ctx) & 0x7fffffffu) +
         "\n<END>\n";
}

} // namespace

void export_mcdc(Job &job) {
  const SimulationBox box = simulation_box(job);
  std::vector<std::string> files;
  std::vector<Surface> surfaces;
  for (const Cell &cell : job.cells) {
    surfaces.push_back(simulation_surface(job, box, cell, SurfaceForm::tiled));
    if (surfaces.back().face.empty()) {
      surfaces.pop_back();
      continue;
    }
    files.push_back(name_of(cell) + ".ply");
    write_ply_file(job, "mcdc/" + files.back(), {&surfaces.back()}, &cell, true);
  }
  std::vector<const Surface *> all;
  for (const Surface &surface : surfaces)
    all.push_back(&surface);
  write_ply_file(job, "mcdc/all_cells.ply", all, nullptr, true);
  const Positions positions = draw_positions(job, box);
  job.text_file("mcdc/protocol.scheme", "protocol", scheme_text(job.options.protocol, gamma_mcdc));
  job.text_file("mcdc/walkers_intra_mm.txt", "positions", rows_text(positions.inside, 1e-3));
  job.text_file("mcdc/walkers_extra_mm.txt", "positions", rows_text(positions.outside, 1e-3));
  job.text_file("mcdc/intra.conf", "configuration",
                conf_text(job, box, "intra", positions.inside.size(), files));
  job.text_file("mcdc/extra.conf", "configuration",
                conf_text(job, box, "extra", positions.outside.size(), files));
}

} // namespace conceg::exporting
