// SPDX-License-Identifier: BSD-3-Clause
#include "restore.hpp"

#include "calibre.hpp"
#include "course.hpp"
#include "edit.hpp"
#include "guard.hpp"
#include "occupancy.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::grow {

namespace {

constexpr double done_within_um = 1e-3; // as growth ends a bar

glm::dvec3 place_of(const Earlier &earlier, std::uint64_t row) {
  return {earlier.position[3 * row], earlier.position[3 * row + 1], earlier.position[3 * row + 2]};
}

// The nearest node stands for the place that the vertex had in the network; none farther away than an edge is
// long.
void find_node(const State &state, Vertex &vertex) {
  const conceg_box &box = state.input.box;
  double nearest = state.parameters.max_edge_um * state.parameters.max_edge_um;
  const Space &space = state.space;
  for (const double within : {0.6, state.parameters.max_edge_um}) {
    for_grid_cells(space.grid, {vertex.position - within, vertex.position + within}, [&](std::size_t cell) {
      for (std::uint64_t i = space.site_offset[cell]; i < space.site_offset[cell + 1]; i++) {
        glm::dvec3 d = space.sites[i].place - vertex.position;
        std::int16_t lift[3];
        for (int a = 0; a < 3; a++) {
          lift[a] = box.periodic[a]
                        ? static_cast<std::int16_t>(-__builtin_floor(d[a] / conceg_box_side(&box, a) + 0.5))
                        : std::int16_t{0};
          d[a] += lift[a] * conceg_box_side(&box, a);
        }
        const double square = glm::dot(d, d);
        if (square > nearest || (square == nearest && space.sites[i].node >= vertex.node)) continue;
        nearest = square, vertex.node = space.sites[i].node;
        std::copy(lift, lift + 3, vertex.lift);
      }
    });
    if (nearest <= within * within) return;
  }
}

// The first vertex of a bar that starts on row `parent` of another one.
void start_on(State &state, std::uint32_t bar, std::uint32_t host, std::uint64_t parent) {
  Projection &projection = state.projections[bar], &carrier = state.projections[host];
  const std::uint64_t vertex = parent - carrier.fixed_row;
  if (vertex == 0)
    fail(CONCEG_E_RANGE,
         "/skeleton/parent: bar %u starts where bar %u does; grow.finish carries on skeletons of "
         "conceg grow only",
         bar, host);
  const Vertex &fork = carrier.chain[vertex];
  projection.host = host;
  projection.chain.assign(1, fork);
  projection.chain[0].segment = none;
  carrier.forks.push_back({bar, static_cast<std::uint32_t>(vertex), fork.position, fork.path});
}

// Path lengths along the line as it runs now, stretched to what the bar has achieved.
void count_path(const State &state, std::uint32_t bar, Projection &projection) {
  const double start = state.input.earlier.achieved_start[bar], end = state.input.earlier.achieved_end[bar];
  std::vector<Vertex> &chain = projection.chain;
  double length = 0.0;
  for (std::size_t i = 1; i < chain.size(); i++)
    length += glm::distance(chain[i].position, chain[i - 1].position);
  const double stretch = length > 0.0 && end > start ? (end - start) / length : 1.0;
  projection.start_path = chain[0].path = start;
  for (std::size_t i = 1; i < chain.size(); i++)
    chain[i].path = chain[i - 1].path + stretch * glm::distance(chain[i].position, chain[i - 1].position);
}

void occupy(State &state, std::uint32_t bar) {
  Projection &projection = state.projections[bar];
  Space &space = state.space;
  for (std::size_t i = 1; i < projection.chain.size(); i++) {
    const auto id = static_cast<std::uint32_t>(space.segments.size());
    projection.chain[i].segment = id;
    space.segments.push_back(segment_at(state, bar, projection.chain, i));
    space.segments[id].in_field = 1;
    insert_capsule(space, id);
    lower_field(state.input, space, id);
    const std::uint32_t node = projection.chain[i].node;
    if (node != none && space.site(node).user == none) space.site(node).user = projection.cell;
  }
}

// What a bar knows beyond its line: its laws, and whether it is done.
void take_up(State &state, std::uint32_t bar) {
  Projection &projection = state.projections[bar];
  projection.settled = projection.fixed = static_cast<std::uint32_t>(projection.chain.size());
  projection.best_path = projection.chain.back().path;
  if (projection.host != none) {
    projection.radius_limit = law_radius(state, projection.host, projection.start_path);
    draw_calibre(state, bar);
  }
  draw_wander(state, bar);
  const double left = state.input.bars.asked_end[bar] - projection.chain.back().path;
  // Without a node near its tip a bar has no edge to go on by.
  projection.phase = left <= done_within_um                 ? Phase::done
                     : projection.chain.back().node == none ? Phase::cut_short
                                                            : Phase::growing;
}

} // namespace

void restore(State &state) {
  const Earlier &earlier = state.input.earlier;
  const Bars &bars = state.input.bars;
  std::vector<std::uint32_t> order; // of the bars' first points: hosts before what they bear
  for (std::uint32_t cell = 0; cell < state.input.cells.count && earlier.rows; cell++) {
    const std::uint64_t first = earlier.cell_offset[cell];
    for (std::uint64_t row = first; row < earlier.cell_offset[cell + 1]; row++) {
      const auto bar = static_cast<std::uint32_t>(bars.cell_offset[cell] + earlier.bar[row]);
      Projection &projection = state.projections[bar];
      if (projection.chain.empty()) {
        order.push_back(bar);
        const bool root = earlier.parent[row] < 0;
        projection.fixed_row = root ? row : row - 1;
        if (!root) {
          const std::uint64_t parent = first + static_cast<std::uint64_t>(earlier.parent[row]);
          start_on(state, bar, static_cast<std::uint32_t>(bars.cell_offset[cell] + earlier.bar[parent]),
                   parent);
        }
      }
      Vertex vertex;
      vertex.position = place_of(earlier, row);
      const double committed =
          std::max(state.parameters.radius_fraction * earlier.target_radius[row], state.parameters.r_min_um);
      vertex.radius = std::min(earlier.radius[row], static_cast<float>(committed));
      find_node(state, vertex);
      projection.chain.push_back(vertex);
    }
  }
  for (const std::uint32_t bar : order) {
    if (state.projections[bar].chain.size() < 2)
      fail(CONCEG_E_RANGE,
           "/skeleton/bar: bar %u has one point; grow.finish carries on skeletons of conceg grow only", bar);
    count_path(state, bar, state.projections[bar]);
    for (Fork &fork : state.projections[bar].forks)
      fork.path = state.projections[bar].chain[fork.vertex].path;
    occupy(state, bar);
    take_up(state, bar);
  }
}

} // namespace conceg::grow
