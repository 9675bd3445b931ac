// SPDX-License-Identifier: BSD-3-Clause
// An edit of one projection's tail: proposed against a frozen state, reserved, then committed beside others.
#pragma once

#include "state.hpp"

namespace conceg::grow {

struct Edit {
  enum class Kind { step, start, collapse, start_failed, end };
  Kind kind = Kind::step;
  std::uint32_t bar = none;
  std::uint32_t keep = 0;    // vertices of the chain that stay as they are
  std::vector<Vertex> tail;  // what follows them; segment == none where the segment is new
  std::uint32_t settled = 0; // settled vertices afterwards
  bool finished = false;     // the bar ends here
  bool arrived = false;      // the attractor is reached: it moves on to `attractor`
  glm::dvec3 attractor{0.0};
  float angle_error = -1.0f;         // start only
  std::vector<std::uint32_t> banned; // nodes not to be tried again
  std::vector<Region> writes, reads; // where the state is changed, and where it was looked at
  std::vector<std::uint32_t> write_cells, read_cells; // the grid cells of these regions
  double tip_before = 0.0; // path of the tip, and settled vertices, before the commit
  std::uint32_t settled_before = 0;
  std::vector<std::uint32_t> fresh,
      freed; // segment numbers given before, and to be returned after the commit
  void clear(std::uint32_t new_bar);
};

// The segment that ends at vertex `index` of a line.
Segment segment_at(const State &state, std::uint32_t bar, const std::vector<Vertex> &line, std::size_t index);

// Turns a changed copy of the chain from vertex `offset` on into the edit's tail, settled up to `settled`.
void edit_from_line(const State &state, const std::vector<Vertex> &line, std::uint32_t offset,
                    std::uint32_t settled, Edit &edit);
// Keeps only the first `keep` vertices.
void edit_cut(const State &state, std::uint32_t keep, Edit &edit);

// Lists the grid cells of the regions.
void list_cells(const Grid &grid, Edit &edit);

// Serial: gives numbers to the edit's new segments.
void number_segments(Space &space, Edit &edit);
// May run beside commits whose regions are apart: capsules, field, users of nodes and the chain itself.
void commit(State &state, Edit &edit);
// Serial: numbers that became free.
void return_segments(Space &space, Edit &edit);

} // namespace conceg::grow
