// SPDX-License-Identifier: BSD-3-Clause
// Morphometrics of one cell, per section, per group of neurites and per radius of Sholl: what NeuroM
// measures, by its definitions where it has one. Real and synthetic cells go through this one code. Lengths
// in um, angles in rad.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace conceg::metrics {

// One cell as plain arrays; parents come before their children, parent -1 = the first sample of a tree. The
// gap between soma and tree is no cable.
struct Samples {
  std::vector<glm::dvec3> position;
  std::vector<double> radius;
  std::vector<int> kind; // SWC code
  std::vector<std::int64_t> parent;
  glm::dvec3 soma{0.0};
  double soma_radius = 0.0;
  std::size_t size() const { return position.size(); }
};

// "None" in a column that a section may not have: a fork's angle at a tip, straightness of a path below 2 um.
constexpr double none = -1.0;
constexpr double resample_step_um = 1.0, shortest_judged_um = 2.0;

// A section = branch: from the fork that it leaves (the first sample of its tree) to its own end: a fork, a
// tip or a change of type.
struct Section {
  std::int64_t parent = -1; // section; parents come first
  std::uint32_t tree = 0;
  int kind = 0;      // of its own samples
  int order = 1;     // 1 at the root; a change of type is not counted
  int ancestors = 0; // sections before it, changes of type counted: NeuroM's branch order
  int strahler = 1;
  std::uint32_t children = 0, samples = 0;
  std::size_t last = 0; // sample at its end
  double length = 0.0, chord = 0.0;
  double straightness = 1.0;      // chord / length as traced, 1 without length
  double straightness_1um = none; // the same, resampled every 1 um; none below 2 um of path
  double path_distance = 0.0;     // from the first sample of the tree to its end
  double radial_distance = 0.0;   // from the soma's centre to its end
  double mean_radius = 0.0;       // by length; of the samples without length
  double taper = 0.0; // slope of the radius along the path by least squares, 0 for fewer than two places
  double area = 0.0, volume = 0.0; // of its frusta
  double local_angle =
      none; // at its end, if that is a fork of two: between their first segments of some length
  double remote_angle = none;     // and between the chords of the two sections
  double rall_ratio = none;       // sum of r^3/2 just after its end / r^3/2 at its end; at forks
  double sibling_ratio = none;    // thinner / thicker just after its end; at forks of two
  double asymmetry = none;        // |n - m| / (n + m) over the sections in the two subtrees, 0 for 1 and 1
  double tip_straightness = none; // tips: first sample of the tree to the tip, as traced
  double tip_straightness_1um = none;
};

struct Spread {
  std::uint64_t count = 0;
  double mean = 0.0, sd = 0.0; // population; 0 without values
};

constexpr int all_kinds = -1;

// One group of a cell's trees: all, or those whose first section has one SWC code.
struct Group {
  int kind = all_kinds;
  std::uint64_t trees = 0, sections = 0, forks = 0, bifurcations = 0, tips = 0;
  double length = 0.0, area = 0.0, volume = 0.0;
  Spread order, ancestors, section_length, straightness, straightness_1um, tip_straightness,
      tip_straightness_1um, local_angle, remote_angle, taper, rall_ratio, asymmetry, tip_path;
  int order_largest = 0, strahler_largest = 0;
  double path_largest = 0.0, radial_largest = 0.0;
  std::array<double, 3> extent{};   // of its samples along x, y, z
  double hull_volume = 0.0;         // of the convex hull of its samples; 0 when they are flat
  std::vector<std::uint64_t> sholl; // crossings of the spheres about the soma, at 1, 2, ... steps
};

struct Metrics {
  std::vector<Section> sections;
  std::vector<Group> groups; // all first, then each code that occurs, ascending
};

// `sholl_step_um` is the distance of the spheres; they end with the last one that is crossed.
Metrics measure(const Samples &cell, double sholl_step_um);

// Volume of the convex hull of points; 0 for fewer than four or flat ones. `corners` (may be null) receives
// points with the same hull: its corners, or all points where there is no volume.
double hull_volume(const std::vector<glm::dvec3> &points, std::vector<glm::dvec3> *corners);

} // namespace conceg::metrics
