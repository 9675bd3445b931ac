// SPDX-License-Identifier: BSD-3-Clause
// What is drawn: cells as triangle surfaces, or as round cones where there are no surfaces yet, either whole
// or as they fill the box.
#pragma once

#include "palette.hpp"
#include "parallel.hpp"
#include "round_cone.hpp"
#include "tile.hpp"

#include <string>
#include <vector>

namespace conceg::rendering {

// One cell, unwrapped; either a surface or cones.
struct Cell {
  std::uint64_t row = 0, id = 0;
  std::uint32_t type = 0;
  Surface surface;
  std::vector<RoundCone> cones;
};

// A cell as it is drawn.
struct Body {
  Colour colour; // sRGB
  std::uint32_t type = 0;
  std::vector<glm::dvec3> vertex;
  std::vector<glm::vec3> normal; // per vertex, unit
  std::vector<glm::uvec3> face;
  std::vector<RoundCone> cones;
};

struct Scene {
  conceg_box box = {};
  glm::dvec3 pia = glm::dvec3(0, 0, 1);
  bool clipped = true;            // periodic axes are cut off at the box
  bool wire = false;              // the edges of the triangles are drawn
  std::vector<std::string> types; // names
  std::vector<Colour> type_colour;
  std::vector<Body> bodies;
  glm::dvec3 lo = glm::dvec3(0.0),
             hi = glm::dvec3(0.0); // bounds of what is seen, the box included when clipped
};

// Makes bodies of cells: tiled into the box when `clipped`, else as they are.
void add_bodies(Scene &scene, const std::vector<Cell> &cells, Workers &workers, const Progress &progress);

// Cuts a scene of bodies down to a cube of `size` um around `centre`, which is moved to lie within the bounds
// as far as it fits. Cells that have nothing in it leave the scene.
void zoom(Scene &scene, const glm::dvec3 &centre, double size);

} // namespace conceg::rendering
