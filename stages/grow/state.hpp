// SPDX-License-Identifier: BSD-3-Clause
// What growth knows: its input as plain arrays, the parameters, and the state that grows. Lengths in um.
#pragma once

#include "conceg/geom.h"
#include "conceg/rng.h"
#include "walk.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::grow {

constexpr std::uint32_t none = 0xffffffffu;

enum class Occupancy { capsule, nodes };
enum class Hazard { per_um, per_step };

struct Parameters {
  double f = 1.0;                 // weight of l_r against l_t
  bool length_factor = false;     // |s-c| / (1 + |s-c|) in l_t, as the paper prints it
  double lambda_per_um = 2.0;     // of the forks' hazard
  Hazard hazard = Hazard::per_um; // or the paper's probability at each step
  double collapse_um = 5.0;       // g0
  std::uint32_t retries = 5;      // collapses in one place before a bar is ended
  double r_min_um = 0.15;         // no process is thinner
  double radius_fraction = 0.6;   // committed radius / target radius
  double smoothing = 0.5;         // 0 = the line runs from node to node, 1 = the smoothed place
  Occupancy occupancy = Occupancy::capsule;
  double max_edge_um = 2.0; // longer edges are no candidates
};

// ---- Input: views of the document's arrays ----
struct Network {
  std::size_t nodes = 0;
  const double *position = nullptr;           // [nodes][3], in the box
  const float *radius = nullptr;              // [nodes], largest radius allowed
  const std::uint64_t *edge_offset = nullptr; // [nodes + 1]
  const std::uint32_t *edge = nullptr;
  const std::int8_t *edge_shift = nullptr; // [edges][3], may be null
  glm::dvec3 at(std::uint32_t node) const {
    return {position[3 * node], position[3 * node + 1], position[3 * node + 2]};
  }
};
struct Cells {
  std::size_t count = 0;
  const std::uint64_t *id = nullptr;
  const double *soma = nullptr; // [count][3]
  const float *radius = nullptr;
  glm::dvec3 at(std::uint32_t cell) const { return {soma[3 * cell], soma[3 * cell + 1], soma[3 * cell + 2]}; }
};
// How far ln r strays from the taper, and over which path it forgets.
struct CalibreLaw {
  double sd = 0.0; // 0 = the taper alone
  double correlation_length_um = 1.0;
};
struct Bars {
  std::size_t count = 0;
  const std::uint64_t *cell_offset = nullptr;
  const std::uint32_t *tree = nullptr;
  const std::int64_t *parent = nullptr; // row within the cell
  const std::uint8_t *neurite = nullptr;
  const double *asked_start = nullptr, *asked_end = nullptr;
  const double *attractor = nullptr; // [count][3], unwrapped
  const double *angle = nullptr;
  const double *radius = nullptr, *taper = nullptr, *radius_floor = nullptr;
  std::vector<CalibreLaw> calibre = {}; // [count], or empty
};
// What an earlier growth left, as it stands now: /skeleton, and the bars' path lengths. No rows = nothing.
struct Earlier {
  std::size_t rows = 0;
  const std::uint64_t *cell_offset = nullptr;
  const double *position = nullptr;                                // [rows][3], unwrapped
  const float *radius = nullptr, *target_radius = nullptr;         // [rows]
  const std::int64_t *parent = nullptr;                            // row within the cell
  const std::uint32_t *bar = nullptr;                              // row within the cell's bars
  const double *achieved_start = nullptr, *achieved_end = nullptr; // [bars]
};
struct Types {
  std::vector<std::string> name;
  const std::uint32_t *of_cell = nullptr; // null = one type
  std::vector<double> straightness = {};  // asked of each type, 0 = nothing; empty = none is steered
};
struct Input {
  conceg_box box = {};
  Network network;
  Cells cells;
  Bars bars;
  Types types;
  Earlier earlier;
  std::uint64_t seed = 1;
};

// ---- Space ----
// One committed piece of a process (or a soma: half = 0, bar = none), wrapped into the box.
struct Segment {
  glm::dvec3 middle{0.0};
  glm::vec3 half{0.0f};
  float half_length = 0.0f;
  float radius = 0.0f;
  std::uint32_t cell = none, bar = none;
  float path = 0.0f;                // path length at the middle
  std::int16_t lift[3] = {0, 0, 0}; // sides to add to get the unwrapped place
  std::uint8_t in_field = 0;        // 1 = its surface is in the nodes' field
  std::uint8_t alive = 0;
};

// Per node: distance to the surface of the nearest owner and of the nearest other owner, capped at the
// field's reach.
struct NodeField {
  float distance1, distance2;
  std::uint32_t owner1, owner2;
};

// What growth asks of a node; by grid cell, so that what is near in space is near in memory.
struct Site {
  glm::dvec3 place{0.0}; // of the network
  NodeField field;
  std::uint32_t node = none;
  std::uint32_t user = none; // the cell whose path uses it
};

// A segment as a grid cell lists it: enough to pass over it unread.
struct Entry {
  float middle[3];
  float bound; // half length, radius, and what single precision may hide
  std::uint32_t segment;
  int first[3]; // grid cell where the segment's region begins
};

// A uniform grid over the box, periodic where the box is.
struct Grid {
  int count[3] = {1, 1, 1};
  glm::dvec3 lo{0.0}, step{1.0};
  bool periodic[3] = {false, false, false};
  std::size_t cells() const { return static_cast<std::size_t>(count[0]) * count[1] * count[2]; }
};

// An axis-aligned box in any image.
struct Region {
  glm::dvec3 lo, hi;
};

struct Space {
  Grid grid;
  double reach = 1.0;                     // the field knows surfaces up to here
  std::vector<std::uint64_t> site_offset; // sites by grid cell
  std::vector<Site> sites;
  std::vector<std::uint32_t> site_of; // by node
  std::vector<float>
      obstacle; // per node: distance to what no cell owns (reach = nothing); empty when there is none
  std::vector<Segment> segments;
  std::vector<std::uint32_t> free_segments;
  std::vector<std::vector<Entry>> segment_list; // by grid cell
  const Site &site(std::uint32_t node) const { return sites[site_of[node]]; }
  Site &site(std::uint32_t node) { return sites[site_of[node]]; }
};

// ---- Projections ----
struct Vertex {
  glm::dvec3 position{0.0}; // unwrapped
  double path = 0.0;        // path length from the soma surface
  std::uint32_t node = none;
  std::int16_t lift[3] = {0, 0, 0}; // of the node
  float radius = 0.0f;              // committed, of the segment that ends here
  std::uint32_t segment = none;     // none for the first vertex
};

struct Fork {
  std::uint32_t bar;    // of the daughter
  std::uint32_t vertex; // lies on the segment that ends at this vertex
  glm::dvec3 position;
  double path;
};

enum class Phase : std::uint8_t { waiting, orphan, starting, growing, done, cut_short, lost };

// The projection of one bar; same row as the bar.
struct Projection {
  std::uint32_t cell = 0, tree = 0;
  Phase phase = Phase::waiting;
  std::uint32_t host = none, parent = none; // rows over all cells
  double fork_path = 0.0;                   // where it is due on its host
  double start_path = 0.0;
  double radius_limit = 1e30; // parent's taper law at the fork
  Walk calibre;               // g / sd along the path
  Walk wander[3];             // how it strays from its attractor
  glm::dvec3 attractor{0.0};
  glm::dvec3 fork_heading{0.0}; // direction of the host behind the fork
  std::uint32_t fork_nodes[2] = {none, none};
  std::int16_t fork_lifts[2][3] = {};
  std::vector<Vertex> chain;
  std::uint32_t settled = 0; // vertices that no longer move
  std::uint32_t fixed = 0;   // vertices of an earlier growth, which stay
  std::uint64_t fixed_row =
      0; // of vertex i of these is fixed_row + i in Earlier; vertex 0 of a daughter has none
  std::vector<Fork> forks;
  std::vector<std::uint32_t> waiting; // bars due on this projection
  std::vector<std::uint32_t> banned;  // nodes
  double best_path = 0.0;
  std::uint32_t collapses = 0, attempts = 0;
  float angle_error = -1.0f; // between drawn and realised direction of the first edge, rad
  conceg_rng chance = {};
};

struct State {
  Input input;
  Parameters parameters;
  Space space;
  std::vector<Projection> projections;              // one per bar
  std::vector<std::vector<std::uint32_t>> children; // bars whose parent is this bar
  std::vector<double> course; // of each type: above 0 smoother, below 0 wandering, in units of straightness
};

} // namespace conceg::grow
