// SPDX-License-Identifier: BSD-3-Clause
#include "edit.hpp"

#include "course.hpp"
#include "occupancy.hpp"

#include <algorithm>

namespace conceg::grow {

namespace {

bool stays(const Projection &projection, const Edit &edit, std::size_t index) {
  const std::size_t place = index - edit.keep;
  return place < edit.tail.size() && edit.tail[place].segment == projection.chain[index].segment;
}

// A vertex may stand beside its node.
void write_node(const Space &space, std::uint32_t node, Edit &edit) {
  const glm::dvec3 &place = space.site(node).place;
  edit.writes.push_back({place, place});
}

// Regions of what an edit takes away, adds and settles.
void find_writes(const State &state, Edit &edit) {
  const Projection &projection = state.projections[edit.bar];
  const Space &space = state.space;
  for (std::size_t i = std::max<std::size_t>(1, edit.keep); i < projection.chain.size(); i++) {
    if (stays(projection, edit, i)) continue;
    const Segment &segment = space.segments[projection.chain[i].segment];
    // Growing back reads the capsules around every node that the piece could have touched.
    edit.writes.push_back(region_of(segment, segment.in_field ? 2.0 * space.reach : 0.0));
    write_node(space, projection.chain[i].node, edit);
  }
  std::vector<Vertex> line;
  if (edit.keep > 0) line.push_back(projection.chain[edit.keep - 1]);
  line.insert(line.end(), edit.tail.begin(), edit.tail.end());
  const std::uint32_t base = edit.keep > 0 ? edit.keep - 1 : 0;
  for (std::size_t i = 1; i < line.size(); i++) {
    const std::uint32_t index = base + static_cast<std::uint32_t>(i);
    const bool settles = index < edit.settled && index >= projection.settled;
    if (line[i].segment == none) write_node(space, line[i].node, edit);
    if (line[i].segment == none || settles)
      edit.writes.push_back(region_of(segment_at(state, edit.bar, line, i), settles ? space.reach : 0.0));
  }
}

// Nodes of what an edit takes away.
void release_nodes(State &state, const Edit &edit) {
  const Projection &projection = state.projections[edit.bar];
  for (std::size_t i = std::max<std::size_t>(1, edit.keep); i < projection.chain.size(); i++) {
    if (stays(projection, edit, i)) continue;
    std::uint32_t &user = state.space.site(projection.chain[i].node).user;
    if (user == projection.cell) user = none;
  }
}

} // namespace

void Edit::clear(std::uint32_t new_bar) {
  kind = Kind::step, bar = new_bar, keep = 0, settled = 0, finished = false, arrived = false,
  angle_error = -1.0f;
  tail.clear(), banned.clear(), writes.clear(), reads.clear(), fresh.clear(), freed.clear();
}

Segment segment_at(const State &state, std::uint32_t bar, const std::vector<Vertex> &line,
                   std::size_t index) {
  const Vertex &from = line[index - 1], &to = line[index];
  return make_segment(state.input.box, from.position, to.position, to.radius, state.projections[bar].cell,
                      bar, 0.5 * (from.path + to.path));
}

void edit_from_line(const State &state, const std::vector<Vertex> &line, std::uint32_t offset,
                    std::uint32_t settled, Edit &edit) {
  edit.keep = state.projections[edit.bar].settled;
  edit.settled = settled;
  edit.tail.assign(line.begin() + (edit.keep - offset), line.end());
  find_writes(state, edit);
}

void edit_cut(const State &state, std::uint32_t keep, Edit &edit) {
  edit.keep = keep;
  edit.settled = std::min(keep, state.projections[edit.bar].settled);
  find_writes(state, edit);
}

void list_cells(const Grid &grid, Edit &edit) {
  edit.write_cells.clear(), edit.read_cells.clear();
  const auto list = [&](const std::vector<Region> &regions, std::vector<std::uint32_t> &cells) {
    for (const Region &region : regions)
      for_grid_cells(grid, region,
                     [&](std::size_t cell) { cells.push_back(static_cast<std::uint32_t>(cell)); });
  };
  list(edit.writes, edit.write_cells), list(edit.reads, edit.read_cells);
  for (std::vector<std::uint32_t> *cells : {&edit.write_cells, &edit.read_cells}) {
    std::sort(cells->begin(), cells->end());
    cells->erase(std::unique(cells->begin(), cells->end()), cells->end());
  }
}

void number_segments(Space &space, Edit &edit) {
  for (std::size_t i = 0; i < edit.tail.size(); i++) {
    if (edit.tail[i].segment != none || edit.keep + i == 0) continue;
    if (space.free_segments.empty()) {
      edit.fresh.push_back(static_cast<std::uint32_t>(space.segments.size()));
      space.segments.emplace_back();
    } else {
      edit.fresh.push_back(space.free_segments.back());
      space.free_segments.pop_back();
    }
  }
}

void commit(State &state, Edit &edit) {
  Projection &projection = state.projections[edit.bar];
  Space &space = state.space;
  edit.tip_before = projection.chain.empty() ? 0.0 : projection.chain.back().path;
  edit.settled_before = projection.settled;
  release_nodes(state, edit);
  if (edit.arrived) projection.attractor = edit.attractor;
  if (edit.kind == Edit::Kind::start) draw_wander(state, edit.bar);
  std::vector<Segment> removed;
  for (std::size_t i = std::max<std::size_t>(1, edit.keep); i < projection.chain.size(); i++) {
    if (stays(projection, edit, i)) continue;
    const std::uint32_t id = projection.chain[i].segment;
    if (space.segments[id].in_field) removed.push_back(space.segments[id]);
    remove_capsule(space, id);
    edit.freed.push_back(id);
  }
  if (!removed.empty()) restore_field(state.input, space, removed);
  projection.chain.resize(edit.keep);
  std::size_t next = 0;
  for (const Vertex &vertex : edit.tail) {
    projection.chain.push_back(vertex);
    const std::size_t index = projection.chain.size() - 1;
    if (vertex.segment != none || index == 0) continue;
    space.site(vertex.node).user = projection.cell;
    const std::uint32_t id = edit.fresh[next++];
    projection.chain.back().segment = id;
    space.segments[id] = segment_at(state, edit.bar, projection.chain, index);
    insert_capsule(space, id);
  }
  projection.settled = edit.settled;
  for (std::uint32_t i = std::max(1u, std::min(edit.settled_before, edit.keep)); i < projection.settled;
       i++) {
    const std::uint32_t id = projection.chain[i].segment;
    space.segments[id].in_field = 1;
    lower_field(state.input, space, id);
  }
}

void return_segments(Space &space, Edit &edit) {
  space.free_segments.insert(space.free_segments.end(), edit.freed.begin(), edit.freed.end());
  edit.freed.clear();
}

} // namespace conceg::grow
