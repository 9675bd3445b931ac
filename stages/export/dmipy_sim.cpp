// SPDX-License-Identifier: BSD-3-Clause
// dmipy-sim: a PLY in um that it scales to metres, the periodic box given outright, and the smallest radius,
// from which it takes its step.
#include "simulation.hpp"

namespace conceg::exporting {

void export_dmipy(Job &job) {
  const SimulationBox box = simulation_box(job);
  const Surface all = joint_surface(job, box, SurfaceForm::cut);
  write_ply_file(job, "dmipy-sim/mesh.ply", {&all}, nullptr, false);
  job.text_file("dmipy-sim/protocol.scheme", "protocol",
                scheme_text(job.options.protocol, gamma_camino_schemes));
  const std::string metres = triple_text(box.sides * 1e-6);
  job.text_file("dmipy-sim/mesh.py", "script",
                "\"\"\"This substrate as a dmipy-sim mesh (import it, or copy the call).\"\"\"\nimport "
                "pathlib\n\nhere = pathlib.Path(__file__).parent\n\n\n"
                "def mesh(**more):\n    from dmipy_sim import Mesh\n\n    return Mesh.from_ply(\n        "
                "str(here / \"mesh.ply\"), scale=1e-6, periodic=" +
                    std::string(box.periodic ? "True" : "False") +
                    ",\n        voxel_min=(0.0, 0.0, 0.0), voxel_max=(" + metres +
                    "),\n        feature_radius=" + number_text(feature_radius(job) * 1e-6) + ", **more)\n");
}

} // namespace conceg::exporting
