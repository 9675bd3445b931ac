// SPDX-License-Identifier: BSD-3-Clause
#include "roots.hpp"

#include "calibre.hpp"
#include "navigate.hpp"
#include "occupancy.hpp"
#include "step.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace conceg::grow {

namespace {

constexpr double first_node_um = 1.0;      // beyond the surface
constexpr double least_stub_um = 0.3;      // the node must be that far outside
constexpr double search_um[] = {1.2, 2.5, 5.0}; // around the place aimed at

// Free nodes around a place, nearest first (ties: lower node).
std::vector<Candidate> free_nodes(const State &state, const Projection &projection, const glm::dvec3 &aim,
                                  double within) {
  std::vector<Candidate> found;
  const conceg_box &box = state.input.box;
  const glm::dvec3 soma = state.input.cells.at(projection.cell);
  const double soma_radius = state.input.cells.radius[projection.cell];
  const double least = soma_radius > 0.0 ? soma_radius + least_stub_um : 0.0;
  for_grid_cells(state.space.grid, {aim - within, aim + within}, [&](std::size_t cell) {
    for (std::uint64_t i = state.space.site_offset[cell]; i < state.space.site_offset[cell + 1]; i++) {
      const Site &site = state.space.sites[i];
      Candidate candidate;
      candidate.node = site.node;
      for (int a = 0; a < 3; a++) {
        const double d = site.place[a] - aim[a];
        const double lift = box.periodic[a] ? -__builtin_floor(d / conceg_box_side(&box, a) + 0.5) : 0.0;
        candidate.lift[a] = static_cast<std::int16_t>(lift);
      }
      candidate.position = node_place(state.input, candidate.node, candidate.lift);
      candidate.cost = glm::distance(candidate.position, aim);
      if (candidate.cost > within || glm::distance(candidate.position, soma) < least) continue;
      if (site.user == projection.cell) continue;
      const double allowed = allowed_radius(site.field, projection.cell);
      if (allowed < state.parameters.r_min_um) continue;
      candidate.allowed =
          allowed >= state.space.reach ? std::numeric_limits<float>::infinity() : static_cast<float>(allowed);
      found.push_back(candidate);
    }
  });
  std::sort(found.begin(), found.end(), [](const Candidate &x, const Candidate &y) {
    return x.cost < y.cost || (x.cost == y.cost && x.node < y.node);
  });
  return found;
}

Vertex vertex_at(const Candidate &candidate) {
  Vertex vertex;
  vertex.position = candidate.position, vertex.node = candidate.node;
  for (int a = 0; a < 3; a++)
    vertex.lift[a] = candidate.lift[a];
  return vertex;
}

// A bar of a cell without soma.
bool propose_free_root(const State &state, std::uint32_t bar, Edit &edit) {
  const Projection &projection = state.projections[bar];
  const glm::dvec3 place = state.input.cells.at(projection.cell);
  for (const double within : search_um) {
    for (const Candidate &start : free_nodes(state, projection, place, within)) {
      const Tip tip{start.position, start.node, {start.lift[0], start.lift[1], start.lift[2]}};
      std::vector<Candidate> candidates;
      find_candidates(state, projection, tip, law_radius(state, bar, 0.0), projection.attractor, candidates);
      for (const Candidate &candidate : candidates) {
        Vertex first = vertex_at(start), second = vertex_at(candidate);
        second.path = glm::distance(first.position, second.position);
        if (second.path >= state.input.bars.asked_end[bar]) continue;
        const double radius = edge_radius(state, bar, first, candidate);
        if (radius < state.parameters.r_min_um) continue;
        first.radius = second.radius = static_cast<float>(radius);
        edit.tail = {first, second};
        edit.settled = 1;
        return true;
      }
    }
  }
  return false;
}

} // namespace

bool propose_root(const State &state, std::uint32_t bar, Edit &edit) {
  edit.clear(bar);
  edit.kind = Edit::Kind::start;
  const Projection &projection = state.projections[bar];
  if (!(state.input.cells.radius[projection.cell] > 0.0f)) return propose_free_root(state, bar, edit);
  const glm::dvec3 soma = state.input.cells.at(projection.cell);
  const double soma_radius = state.input.cells.radius[projection.cell];
  const glm::dvec3 line = projection.attractor - soma;
  const double length = glm::length(line);
  const glm::dvec3 along = length > 0.0 ? line / length : glm::dvec3(0.0, 0.0, 1.0);
  const glm::dvec3 aim = soma + along * (soma_radius + first_node_um);
  for (const double within : search_um) {
    for (const Candidate &candidate : free_nodes(state, projection, aim, within)) {
      const glm::dvec3 out = glm::normalize(candidate.position - soma);
      Vertex surface, node;
      surface.position = soma + out * soma_radius;
      surface.node = node.node = candidate.node;
      for (int a = 0; a < 3; a++)
        surface.lift[a] = node.lift[a] = candidate.lift[a];
      node.position = candidate.position;
      node.path = glm::distance(surface.position, node.position);
      if (node.path >= state.input.bars.asked_end[bar]) continue;
      const double radius = edge_radius(state, bar, surface, candidate);
      if (radius < state.parameters.r_min_um) continue;
      surface.radius = node.radius = static_cast<float>(radius);
      edit.tail = {surface, node};
      edit.settled = 1;
      return true;
    }
  }
  return false;
}

} // namespace conceg::grow
