// SPDX-License-Identifier: BSD-3-Clause
#include "step.hpp"

#include "branch.hpp"
#include "calibre.hpp"
#include "collapse.hpp"
#include "course.hpp"
#include "occupancy.hpp"
#include "smooth.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::grow {

namespace {

// Everything that a step looks at: nodes and capsules around the tip, capsules around the open line.
void note_reads(const State &state, const Projection &projection, const std::vector<Vertex> &line,
                double want, Edit &edit) {
  const glm::dvec3 tip = projection.chain.back().position;
  const double around = state.parameters.max_edge_um + want;
  edit.reads.push_back({tip - around, tip + around});
  Region open{tip, tip};
  for (const Vertex &vertex : line)
    open.lo = glm::min(open.lo, vertex.position), open.hi = glm::max(open.hi, vertex.position);
  edit.reads.push_back({open.lo - want, open.hi + want});
}

// What the tip grows towards. At its attractor it runs straight on for the length that is left, or it would
// circle there.
glm::dvec3 aim(const State &state, const Projection &projection, Edit &edit) {
  const Vertex &tip = projection.chain.back();
  const glm::dvec3 heading = chain_heading(projection);
  if (!attractor_reached(projection.attractor, tip.position, heading)) return projection.attractor;
  const double beyond_um = 20.0; // farther than the tip gets, so that this attractor is never reached
  edit.arrived = true;
  edit.attractor = tip.position + heading * (state.input.bars.asked_end[edit.bar] - tip.path + beyond_um);
  return edit.attractor;
}

} // namespace

double edge_radius(const State &state, std::uint32_t bar, const Vertex &from, const Candidate &candidate) {
  const double length = glm::distance(from.position, candidate.position);
  const double want = wanted_radius(state, bar, from.path, from.path + length);
  const double need = state.parameters.r_min_um;
  // The field of the nodes knows no farther than the widest taper.
  const double known = calibre_varies(state, bar) ? state.space.reach : want;
  if (state.parameters.occupancy == Occupancy::nodes)
    return std::min({want, static_cast<double>(candidate.allowed), known});
  const Segment probe = make_segment(state.input.box, from.position, candidate.position, want,
                                     state.projections[bar].cell, bar, from.path + 0.5 * length);
  return clearance(state, probe, want, need);
}

void propose(const State &state, std::uint32_t bar, Edit &edit) {
  edit.clear(bar);
  const Projection &projection = state.projections[bar];
  if (projection.phase == Phase::starting) return propose_start(state, bar, edit);
  const Vertex &last = projection.chain.back();
  const Tip tip{last.position, last.node, {last.lift[0], last.lift[1], last.lift[2]}};
  const glm::dvec3 target =
      wandering_target(state, bar, last.position, last.path, aim(state, projection, edit));
  std::vector<Candidate> candidates;
  find_candidates(state, projection, tip, law_radius(state, bar, last.path), target, candidates);
  std::uint32_t offset = 0;
  std::vector<Vertex> line = open_line(projection, offset);
  for (const Candidate &candidate : candidates) {
    const double radius = edge_radius(state, bar, last, candidate);
    if (radius < state.parameters.r_min_um) continue;
    Vertex next;
    next.position = candidate.position, next.node = candidate.node, next.radius = static_cast<float>(radius);
    for (int a = 0; a < 3; a++)
      next.lift[a] = candidate.lift[a];
    next.path = last.path + glm::distance(last.position, candidate.position);
    line.push_back(next);
    const double end = state.input.bars.asked_end[bar];
    const std::size_t open = projection.settled - offset;
    const bool flush = settled_length(state, bar, line, open) >= end;
    note_reads(state, projection, line, widest_wanted(state, bar, line.front().path, next.path), edit);
    const std::size_t settled = settle_line(state, bar, line, open, flush, end, edit.finished);
    edit_from_line(state, line, offset, static_cast<std::uint32_t>(settled) + offset, edit);
    return;
  }
  note_reads(state, projection, line, widest_wanted(state, bar, last.path, last.path), edit);
  propose_collapse(state, bar, edit);
}

} // namespace conceg::grow
