// SPDX-License-Identifier: BSD-3-Clause
// From the samples of a reconstruction to the trees that are characterised.
#pragma once

#include "morphology.hpp"

namespace conceg::characterise {

// Neurite samples as a reader gives them: parents before children.
struct Samples {
  std::vector<glm::dvec3> position;
  std::vector<double> radius;
  std::vector<int> kind;
  std::vector<std::int64_t> parent; // -1 = on the soma or floating
  std::vector<bool> on_soma;
  std::size_t size() const { return position.size(); }
};

struct Cleaning {
  bool glia = false;        // all processes are glial (code 7)
  bool axons = false;       // keep the largest axon tree that is joined to the cell
  double axon_gap_um = 0.0; // and join to it the loose pieces of axon that are no farther than this; 0 = none
  double twig_length_um =
      0.0; // terminal sections shorter and thinner than these two are spines; 0 = keep all
  double twig_radius_um = 0.0;
  double tree_length_um = 0.0; // trees with less cable are left out
  double lowest_radius_um = 0.0;
  bool clip_at_soma = false; // trees start where they leave the soma sphere
};

struct Cleaned {
  std::size_t twigs = 0, floating = 0, axon_pieces = 0, short_trees = 0, raised_radii = 0;
  std::size_t joined_pieces = 0; // of the axon: kept, over gaps
  double bridged_um = 0.0;       // the sum of those gaps
  Cleaned &operator+=(const Cleaned &other);
};

// Trees on the soma; a tree's neurite is the code with most cable in it. What was left out is counted.
std::vector<Tree> clean_trees(const Samples &samples, const glm::dvec3 &soma, double soma_radius,
                              const Cleaning &rules, Cleaned &count);

// Takes the terminal sections below both limits off; of a fork with only such children the longest stays.
std::size_t remove_twigs(Tree &tree, double length_um, double radius_um);

// Cuts what lies inside the soma sphere off; the parts outside that were joined by it become trees of their
// own.
std::vector<Tree> clip_at_sphere(const Tree &tree, const glm::dvec3 &center, double radius_um);

} // namespace conceg::characterise
