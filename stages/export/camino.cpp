// SPDX-License-Identifier: BSD-3-Clause
// Camino's datasynth: one PLY in metres, the separation of its copies, a scheme. Camino takes the bounds of
// the triangles for its box and grows them to the separation: where the mesh is cut they are the box, and
// along an axis where it is not, the lattice of its copies stands as well anywhere. Whether a point lies in a
// cell it tells only by a header comment "closed surface" and a ray, which open rims mislead: walkers start
// inside where nothing is cut, and anywhere in the box where something may be.
#include "cut.hpp"
#include "simulation.hpp"

namespace conceg::exporting {

void export_camino(Job &job) {
  const SimulationBox box = simulation_box(job);
  Surface all = placed(joint_surface(job, box, SurfaceForm::cut), glm::dvec3(0.0), 1e-6);
  all.vertex.emplace_back(0.0);
  all.vertex.push_back(box.sides * 1e-6);
  write_ply_file(job, "camino/mesh.ply", {&all}, nullptr, true, "lengths in m",
                 box.open ? "closed surface" : nullptr);
  job.text_file("camino/protocol.scheme", "protocol",
                scheme_text(job.options.protocol, gamma_camino_schemes));
  const double echo = job.options.protocol.echo_ms();
  job.text_file("camino/run.sh", "script",
                "#!/bin/sh\n# Signal of this substrate by Camino (http://camino.cs.ucl.ac.uk); big-endian "
                "float32, a value a row of the scheme.\ncd \"$(dirname \"$0\")\" || exit 1\n"
                "datasynth -walkers " +
                    std::to_string(job.options.walkers) + " -tmax " +
                    std::to_string(static_cast<long>(echo * 1000.0 + 0.5)) +
                    " -p 0 -geometry ply -plyfile mesh.ply -meshsep " + triple_text(box.sides * 1e-6, " ") +
                    " -initial " + (box.open ? "intra" : "uniform") + " -diffusivity " +
                    number_text(job.options.diffusivity * 1e-9) +
                    " -schemefile protocol.scheme -voxels 1 -seed " +
                    std::to_string(conceg_ctx_seed(job.ctx) & 0x7fffffffu) + " > signal.Bfloat\n");
}

} // namespace conceg::exporting
