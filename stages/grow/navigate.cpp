// SPDX-License-Identifier: BSD-3-Clause
#include "navigate.hpp"

#include "course.hpp"
#include "occupancy.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace conceg::grow {

double attractor_cost(const glm::dvec3 &s, const glm::dvec3 &c, const glm::dvec3 &t, bool length_factor) {
  const glm::dvec3 step = c - s, target = t - s;
  const double length = std::sqrt(glm::dot(step, step)), distance = std::sqrt(glm::dot(target, target));
  const double cosine = length > 0.0 && distance > 0.0 ? glm::dot(step, target) / (length * distance) : 0.0;
  return 0.5 * (length_factor ? length / (1.0 + length) : 1.0) * (1.0 - cosine);
}

double radius_cost(double r_0, double r_c) {
  return std::max(0.0, (r_0 - r_c) / r_0);
}

glm::dvec3 node_place(const Input &input, std::uint32_t node, const std::int16_t lift[3]) {
  glm::dvec3 place = input.network.at(node);
  for (int a = 0; a < 3; a++)
    if (lift[a]) place[a] += lift[a] * conceg_box_side(&input.box, a);
  return place;
}

void find_candidates(const State &state, const Projection &projection, const Tip &tip, double r_0,
                     const glm::dvec3 &target, std::vector<Candidate> &candidates) {
  const Network &network = state.input.network;
  const Parameters &parameters = state.parameters;
  const double f = radius_weight(state, projection.cell);
  const glm::dvec3 soma = state.input.cells.at(projection.cell);
  const double soma_radius = state.input.cells.radius[projection.cell];
  for (std::uint64_t e = network.edge_offset[tip.node]; e < network.edge_offset[tip.node + 1]; e++) {
    Candidate candidate;
    candidate.node = network.edge[e];
    const Site &site = state.space.site(candidate.node);
    if (site.user == projection.cell) continue;
    const double allowed = allowed_radius(site.field, projection.cell);
    if (allowed < parameters.r_min_um) continue;
    if (std::find(projection.banned.begin(), projection.banned.end(), candidate.node) !=
        projection.banned.end())
      continue;
    for (int a = 0; a < 3; a++)
      candidate.lift[a] =
          static_cast<std::int16_t>(tip.lift[a] + (network.edge_shift ? network.edge_shift[3 * e + a] : 0));
    candidate.position = node_place(state.input, candidate.node, candidate.lift);
    const glm::dvec3 step = candidate.position - tip.position;
    const double square = glm::dot(step, step);
    if (square > parameters.max_edge_um * parameters.max_edge_um || square < 1e-6) continue;
    // The field does not limit a cell by itself: keep out of the own soma here.
    glm::dvec3 from_soma = candidate.position - soma;
    for (int a = 0; a < 3; a++)
      from_soma[a] = conceg_box_nearest(&state.input.box, a, from_soma[a]);
    const double keep = soma_radius + parameters.r_min_um;
    if (soma_radius > 0.0 && glm::dot(from_soma, from_soma) < keep * keep) continue;
    const bool free = allowed >= state.space.reach;
    candidate.allowed = free ? std::numeric_limits<float>::infinity() : static_cast<float>(allowed);
    candidate.cost = attractor_cost(tip.position, candidate.position, target, parameters.length_factor) +
                     f * (free ? 0.0 : radius_cost(r_0, allowed));
    candidates.push_back(candidate);
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate &x, const Candidate &y) {
    return x.cost < y.cost || (x.cost == y.cost && x.node < y.node);
  });
}

bool attractor_reached(const glm::dvec3 &attractor, const glm::dvec3 &tip, const glm::dvec3 &heading) {
  const double near_um = 5.0, past_um = 15.0;
  const glm::dvec3 gap = attractor - tip;
  const double square = glm::dot(gap, gap);
  return square < near_um * near_um || (square < past_um * past_um && glm::dot(gap, heading) < 0.0);
}

glm::dvec3 chain_heading(const Projection &projection) {
  const double reach_um = 5.0;
  const Vertex &tip = projection.chain.back();
  std::size_t from = projection.chain.size() - 1;
  while (from > 0 && tip.path - projection.chain[from].path < reach_um)
    from--;
  glm::dvec3 line = tip.position - projection.chain[from].position;
  if (!(glm::dot(line, line) > 1e-12)) line = projection.attractor - tip.position;
  const double length = glm::length(line);
  return length > 1e-6 ? line / length : glm::dvec3(0.0, 0.0, 1.0);
}

} // namespace conceg::grow
