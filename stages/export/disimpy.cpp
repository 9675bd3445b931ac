// SPDX-License-Identifier: BSD-3-Clause
// DiSimPy reads no files: arrays in metres, and a script that loads them. Its voxel is the bounds of all
// vertices, so two vertices without a face pin the corners; the surfaces are cut at the sides, and walkers
// start where we say, since open surfaces defeat its own test of inside.
#include "cut.hpp"
#include "simulation.hpp"

namespace conceg::exporting {
namespace {

const char script[] = R"(#!/usr/bin/env python3
"""Signal of this substrate by DiSimPy (https://github.com/kerkelae/disimpy), which needs a CUDA GPU.

run.py [intra|extra] [WALKERS] [STEPS]    writes signal_intra.txt or signal_extra.txt: b (s/mm2), direction, S / S0
"""
import pathlib
import sys

import numpy as np
from disimpy import gradients, simulations, substrates

here = pathlib.Path(__file__).parent
where = sys.argv[1] if len(sys.argv) > 1 else "intra"
start = np.load(here / f"positions_{where}_m.npy")
walkers = int(sys.argv[2]) if len(sys.argv) > 2 else len(start)
steps = int(sys.argv[3]) if len(sys.argv) > 3 else @STEPS@
start = start[np.arange(walkers) % len(start)]
substrate = substrates.mesh(
    np.load(here / "vertices_m.npy"), np.load(here / "faces.npy").astype(int), periodic=@PERIODIC@, init_pos=start, n_sv=np.array([@SUBVOXELS@] * 3))
protocol = np.loadtxt(here / "protocol.txt", ndmin=2)  # b in s/m2, direction
gradient, dt = gradients.pgse(@PULSE@, @SEPARATION@, steps, protocol[:, 0], protocol[:, 1:])
signal = simulations.simulation(walkers, @DIFFUSIVITY@, gradient, dt, substrate, seed=1)
np.savetxt(here / f"signal_{where}.txt", np.column_stack([protocol[:, 0] * 1e-6, protocol[:, 1:], signal / walkers]))
)";

std::string filled(std::string text, const std::vector<std::pair<std::string, std::string>> &values) {
  for (const auto &[name, value] : values)
    for (std::size_t at; (at = text.find("@" + name + "@")) != std::string::npos;)
      text.replace(at, name.size() + 2, value);
  return text;
}

} // namespace

void export_disimpy(Job &job) {
  const SimulationBox box = simulation_box(job);
  if (box.periodic == box.open) // neither
    fail(
        CONCEG_E_UNSUPPORTED,
        "disimpy: expected a box that is periodic along all axes or along none, which is what DiSimPy knows");
  Surface all = placed(joint_surface(job, box, SurfaceForm::cut), glm::dvec3(0.0), 1e-6);
  all.vertex.emplace_back(0.0);
  all.vertex.push_back(box.sides * 1e-6);
  write_npy(job, "disimpy/vertices_m.npy", "surfaces", all.vertex);
  write_npy(job, "disimpy/faces.npy", "surfaces", all.face);
  Positions positions = draw_positions(job, box);
  for (std::vector<glm::dvec3> *points : {&positions.inside, &positions.outside})
    for (glm::dvec3 &p : *points)
      p *= 1e-6;
  write_npy(job, "disimpy/positions_intra_m.npy", "positions", positions.inside);
  write_npy(job, "disimpy/positions_extra_m.npy", "positions", positions.outside);
  const Protocol &protocol = job.options.protocol;
  std::string rows;
  for (const Measurement &m : measurements(protocol))
    rows += number_text(m.b * 1e9) + " " + triple_text(m.direction, " ") + "\n";
  job.text_file("disimpy/protocol.txt", "protocol", rows);
  const double subvoxels = std::min(100.0, std::max(5.0, std::cbrt(static_cast<double>(all.face.size()))));
  job.text_file(
      "disimpy/run.py", "script",
      filled(
          script,
          {{"STEPS", std::to_string(
                         static_cast<long>((protocol.separation_ms + protocol.pulse_ms) * 1000.0 + 0.5) + 1)},
           {"PERIODIC", box.periodic ? "True" : "False"},
           {"SUBVOXELS", std::to_string(static_cast<int>(subvoxels))},
           {"PULSE", number_text(protocol.pulse_ms * 1e-3)},
           {"SEPARATION", number_text(protocol.separation_ms * 1e-3)},
           {"DIFFUSIVITY", number_text(job.options.diffusivity * 1e-9)}}));
}

} // namespace conceg::exporting
