// SPDX-License-Identifier: BSD-3-Clause
// A cell as a tree of overlapping spheres, its images in the periodic box, and the share of the box in a
// union of spheres.
#pragma once

#include "source.hpp"

#include <vector>

namespace conceg::exporting {

struct Sphere {
  glm::dvec3 at;       // um
  double inner, outer; // radii, um; inner = outer without myelin
  std::int64_t parent; // an earlier sphere, -1 = none
};

// A connected tree of spheres; the first is the root, and the soma where there is one.
struct SphereTree {
  std::vector<Sphere> spheres;
  bool soma = false;
  glm::ivec3 lift = glm::ivec3(0); // box sides added to the cell's place
};

// The cell's trees, one for each of its connected pieces. Neighbours lie at most a quarter of the thicker
// one's radius apart. `inner` holds one radius for each point of the tree, or nothing.
std::vector<SphereTree> sphere_trees(const Cell &cell, const Tree &tree, const std::vector<double> &inner);

// What of a tree meets the box, at every image: a connected piece each. Along open axes nothing is left out.
std::vector<SphereTree> images_in_box(const SphereTree &whole, const conceg_box &box);

struct Ball {
  glm::dvec3 at; // um, from the box's corner
  double radius;
  bool axon;
};
struct BallShares {
  double axons, all;
};
// Shares of [0, sides] within the balls of axons and within any, by a grid of 512^3 points.
BallShares ball_shares(std::vector<Ball> balls, const glm::dvec3 &sides);

} // namespace conceg::exporting
