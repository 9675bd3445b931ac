// SPDX-License-Identifier: BSD-3-Clause
// The judge: looks at the very values that are written and trusts nothing about how they were made. Exact
// predicates.
#pragma once

#include "parallel.hpp"
#include "surface.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace conceg::mesh {

enum class Flaw : std::uint8_t {
  bad_index,       // a face names a vertex that is not there
  degenerate_face, // a repeated vertex, or three on one line
  unused_vertex,
  open_edge,      // an edge with one face: a hole or a missing triangle
  turned_face,    // two faces run along an edge in the same direction: flipped, or more than two faces at the
                  // edge
  split_vertex,   // a vertex with more than one fan of faces
  inward,         // the enclosed volume is not positive
  crossing_cells, // faces of two cells meet
  crossing_image, // faces of a cell and of its own periodic image meet
  crossing_self,  // faces of one surface meet that have no vertex in common
  fold,           // faces with a common vertex meet elsewhere too
  near,           // faces of two labels are nearer than the least gap
};
const char *flaw_name(Flaw flaw);
inline bool is_pair(Flaw flaw) {
  return flaw >= Flaw::crossing_cells;
}

struct Defect {
  Flaw flaw;
  std::uint32_t surface, face;             // for unused_vertex and split_vertex: face = the vertex
  std::uint32_t other_surface, other_face; // pairs only
  glm::ivec3 lift{};                       // pairs only: the other face is moved by lift * side
  glm::dvec3 where{};                      // um
};

class Bits {
public:
  void reset(std::size_t count) { word_.assign((count + 63) / 64, 0); }
  void set(std::size_t i) { word_[i / 64] |= std::uint64_t(1) << i % 64; }
  void clear(std::size_t i) { word_[i / 64] &= ~(std::uint64_t(1) << i % 64); }
  bool operator[](std::size_t i) const { return word_[i / 64] >> i % 64 & 1; }
  bool empty() const { return word_.empty(); }
  // Is any of first .. last set, whole words of 64 looked at?
  bool any_near(std::size_t first, std::size_t last) const {
    for (std::size_t w = first / 64; w < std::min((last + 63) / 64, word_.size()); w++)
      if (word_[w]) return true;
    return false;
  }

private:
  std::vector<std::uint64_t> word_;
};

// What has been replaced since a result was made: surfaces, and faces of others whose vertices have moved.
struct Changed {
  std::vector<std::uint8_t> surface;
  std::vector<Bits> face = {}; // per surface, empty where none has; or nothing at all
  bool holds(std::uint32_t s, std::uint32_t f) const {
    return surface[s] || (!face.empty() && !face[s].empty() && face[s][f]);
  }
};

struct CheckOptions {
  double reach = 0.09;               // um; gaps are measured up to this
  double least_gap = 0;              // um; pairs nearer than this are listed as near
  std::size_t memory = 512u << 20;   // bytes that the pair test may take
  std::function<void()> forget = {}; // called now and then: pages of files that were read may go
};

struct CheckResult {
  std::vector<Defect> defects; // sorted by flaw, place
  std::uint64_t errors = 0;    // defects that make the meshes unfit: all but near
  std::uint64_t crossings = 0; // pairs among them
  std::uint64_t pairs_checked = 0;
  std::vector<double> min_gap; // per surface: distance to the nearest other label, at most `reach`; of the
                               // pairs that were tested
  std::vector<std::uint8_t> closed; // per surface: no flaw other than crossings
  std::vector<std::uint8_t> usable; // per surface: the pair test can take it
  std::vector<Bits> plain;          // per surface: vertices around which no two faces meet (topology)
};

// Surfaces with bad indices or degenerate faces are reported and left out of the pair test.
CheckResult check_surfaces(const Views &surfaces, const conceg_box &box, const CheckOptions &options,
                           Workers &workers, const Progress &progress);

// Brings `result` up to date after something has been replaced: pairs of two other faces are not tested
// again, and min_gap holds for the pairs tested alone. pairs_checked counts the tests of all times. Where
// single faces have changed, none of them may be without area.
void check_again(const Views &surfaces, const Changed &changed, const conceg_box &box,
                 const CheckOptions &options, Workers &workers, const Progress &progress,
                 CheckResult &result);

// One line that names a defect and its place.
std::string describe(const Defect &defect, const Views &surfaces);

} // namespace conceg::mesh
