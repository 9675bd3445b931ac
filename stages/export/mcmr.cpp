// SPDX-License-Identifier: BSD-3-Clause
// MCMRSimulator.jl: closed cells as text PLY in um; it repeats them itself.
#include "simulation.hpp"

namespace conceg::exporting {

void export_mcmr(Job &job) {
  const SimulationBox box = simulation_box(job);
  std::string names;
  for (const Cell &cell : job.cells) {
    const Surface surface = simulation_surface(job, box, cell, SurfaceForm::whole);
    if (surface.face.empty()) continue;
    const std::string name = name_of(cell) + ".ply";
    write_ply_file(job, "mcmr/" + name, {&surface}, &cell, true);
    names += "    \"" + name + "\",\n";
  }
  if (box.periodic == box.open) // neither
    fail(CONCEG_E_UNSUPPORTED, "mcmr: expected a box that is periodic along all axes or along none");
  const std::string repeats = box.periodic ? "; repeats=[" + triple_text(box.sides) + "]" : "";
  job.text_file("mcmr/geometry.jl", "script",
                "# The cells of this substrate for MCMRSimulator.jl: include(\"geometry.jl\") defines "
                "`geometry`. um, ms.\nusing MCMRSimulator\n\nfiles = [\n" +
                    names + "]\ngeometry = [load_mesh(joinpath(@__DIR__, file)" + repeats +
                    ") for file in files]\n");
}

} // namespace conceg::exporting
