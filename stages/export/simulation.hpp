// SPDX-License-Identifier: BSD-3-Clause
// The substrate in the form that simulators share: a box that begins at 0, surfaces in it, and starting
// points.
#pragma once

#include "job.hpp"

namespace conceg::exporting {

// Where simulators see the substrate. Along a periodic axis the box is the document's; along an open one it
// holds all surfaces with 1 um around, so that no cell touches the box.
struct SimulationBox {
  glm::dvec3 origin, sides; // um; the files hold x - origin, the box is [0, sides]
  bool periodic, open;      // along all axes, along none
};
SimulationBox simulation_box(const Job &job);

enum class SurfaceForm { cut, tiled, whole };
// A cell's surface in the frame of the files, in um: cut at the periodic sides, with all images that meet the
// box, or as it stands.
Surface simulation_surface(const Job &job, const SimulationBox &box, const Cell &cell, SurfaceForm form);
// All of them in one.
Surface joint_surface(const Job &job, const SimulationBox &box, SurfaceForm form);

// Points drawn evenly in the box, in the frame of the files, um: `walkers` of the chosen cells' inside, and
// as many outside of all cells. Fewer when a compartment is so small that 1000 draws a point do not fill it.
struct Positions {
  std::vector<glm::dvec3> inside, outside;
};
Positions draw_positions(const Job &job, const SimulationBox &box);

// Smallest skeleton radius, um; 0 without skeletons.
double feature_radius(const Job &job);

// A NumPy file of rows; doubles, or unsigned 32-bit numbers.
void write_npy(Job &job, const std::string &file, const char *what, const std::vector<glm::dvec3> &rows);
void write_npy(Job &job, const std::string &file, const char *what, const std::vector<glm::uvec3> &rows);
// "x y z" a line.
std::string rows_text(const std::vector<glm::dvec3> &rows, double scale);
// {a, b, c} of numbers in a script.
std::string triple_text(const glm::dvec3 &values, const char *comma = ", ");

} // namespace conceg::exporting
