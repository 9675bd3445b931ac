// SPDX-License-Identifier: BSD-3-Clause
#include "branch.hpp"

#include "calibre.hpp"
#include "course.hpp"
#include "navigate.hpp"
#include "occupancy.hpp"
#include "smooth.hpp"
#include "step.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::grow {

namespace {

constexpr double fork_gap_um = 0.5;   // least path between a projection's ends and a fork on it
constexpr double fork_snap_um = 0.05; // a fork nearer to a vertex takes its place
constexpr double postpone_um = 1.0;   // a fork without a free first edge is tried again that much later
constexpr double exact_cosine =
    0.2; // a narrow fork has its host on the nearest nodes: any node on that side serves
constexpr double shortest_first_um = 0.5;
constexpr std::uint32_t exact_tries = 2; // trapped so often there, it goes where there are nodes

// Where a bar is due on a host that stands at `path`: by the hazard ahead of it, else at its start on the
// line that is there.
void schedule(State &state, std::uint32_t bar, std::uint32_t host, double path) {
  Projection &projection = state.projections[bar];
  const Bars &bars = state.input.bars;
  const double ahead = bars.asked_start[bar] - path;
  double due = bars.asked_start[bar];
  if (ahead > 0.0)
    due -= early_distance(state.parameters.lambda_per_um, ahead, conceg_rng_exponential(&projection.chance));
  due = std::min(due, bars.asked_end[host] - fork_gap_um);
  projection.fork_path = std::max(due, state.projections[host].start_path + fork_gap_um);
  projection.host = host;
  projection.phase = Phase::waiting;
}

struct Place {
  std::uint32_t vertex;
  glm::dvec3 position;
  double path;
};

Place place_on(const Projection &host, double path) {
  auto vertex = static_cast<std::uint32_t>(
      std::lower_bound(host.chain.begin() + 1, host.chain.begin() + host.settled, path,
                       [](const Vertex &v, double p) { return v.path < p; }) -
      host.chain.begin());
  vertex = std::min(vertex, host.settled - 1);
  const Vertex &to = host.chain[vertex], &from = host.chain[vertex - 1];
  for (const Fork &fork : host.forks)
    if (std::fabs(fork.path - path) < fork_snap_um) return {fork.vertex, fork.position, fork.path};
  if (to.path - path < fork_snap_um) return {vertex, to.position, to.path};
  if (vertex > 1 && path - from.path < fork_snap_um) return {vertex - 1, from.position, from.path};
  // What an earlier growth left gets no new points.
  if (vertex < host.fixed && vertex > 1 && path - from.path < to.path - path)
    return {vertex - 1, from.position, from.path};
  if (vertex < host.fixed) return {vertex, to.position, to.path};
  const double part = (path - from.path) / (to.path - from.path);
  return {vertex, from.position + part * (to.position - from.position), path};
}

} // namespace

double early_distance(double lambda, double ahead, double draw) {
  const double sum = conceg_exp(-lambda * ahead) + lambda * hazard_length_um * draw;
  return std::max(0.0, -conceg_log(sum) / lambda);
}

double step_probability(double lambda, double path, double initiation) {
  return path >= initiation ? 1.0 : conceg_exp(lambda * (path - initiation));
}

glm::dvec3 daughter_direction(const glm::dvec3 &heading, const glm::dvec3 &to_attractor, double angle,
                              double azimuth) {
  glm::dvec3 aside = to_attractor - heading * glm::dot(to_attractor, heading);
  double length = glm::length(aside);
  if (!(length > 1e-6 * glm::length(to_attractor)) || !(length > 0.0)) {
    const glm::dvec3 axis = std::fabs(heading.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(heading, axis)), v = glm::cross(heading, u);
    aside = conceg_cos(azimuth) * u + conceg_sin(azimuth) * v;
    length = 1.0;
  }
  return conceg_cos(angle) * heading + (conceg_sin(angle) / length) * aside;
}

void propose_start(const State &state, std::uint32_t bar, Edit &edit) {
  const Projection &projection = state.projections[bar];
  const Vertex &fork = projection.chain.front();
  edit.kind = Edit::Kind::start_failed;
  edit.keep = edit.settled = 1;
  const double around = 2.0 * state.parameters.max_edge_um + widest_wanted(state, bar, fork.path, fork.path);
  edit.reads.push_back({fork.position - around, fork.position + around});

  conceg_rng chance = projection.chance;
  const double azimuth = 6.283185307179586 * conceg_rng_uniform(&chance);
  const glm::dvec3 direction = daughter_direction(
      projection.fork_heading, projection.attractor - fork.position, state.input.bars.angle[bar], azimuth);
  std::vector<Candidate> candidates;
  for (int i = 0; i < 2; i++) {
    if (projection.fork_nodes[i] == none || (i == 1 && projection.fork_nodes[1] == projection.fork_nodes[0]))
      continue;
    const std::int16_t *lift = projection.fork_lifts[i];
    const Tip tip{fork.position, projection.fork_nodes[i], {lift[0], lift[1], lift[2]}};
    find_candidates(state, projection, tip, law_radius(state, bar, fork.path), projection.attractor,
                    candidates);
  }
  for (Candidate &candidate : candidates)
    candidate.cost = 1.0 - glm::dot(glm::normalize(candidate.position - fork.position), direction);
  std::sort(candidates.begin(), candidates.end(), [](const Candidate &x, const Candidate &y) {
    return x.cost < y.cost || (x.cost == y.cost && x.node < y.node);
  });
  for (const Candidate &candidate : candidates) {
    Candidate used = candidate;
    double radius = -1.0;
    if (smoothing_of(state, bar) > 0.0 && state.parameters.occupancy == Occupancy::capsule &&
        candidate.cost < 1.0 - exact_cosine && projection.collapses < exact_tries) {
      const double length = std::max(glm::distance(fork.position, candidate.position), shortest_first_um);
      used.position = fork.position + length * direction;
      radius = edge_radius(state, bar, fork, used);
    }
    if (radius < state.parameters.r_min_um)
      used = candidate, radius = edge_radius(state, bar, fork, candidate);
    if (radius < state.parameters.r_min_um) continue;
    Vertex first;
    first.position = used.position, first.node = used.node, first.radius = static_cast<float>(radius);
    for (int a = 0; a < 3; a++)
      first.lift[a] = used.lift[a];
    first.path = fork.path + glm::distance(fork.position, used.position);
    edit.kind = Edit::Kind::start;
    edit.angle_error = static_cast<float>(
        conceg_acos(glm::dot(glm::normalize(used.position - fork.position), glm::normalize(direction))));
    std::vector<Vertex> line = {fork, first};
    edit.finished = cut_at(line, 1, state.input.bars.asked_end[bar]);
    edit_from_line(state, line, 0, 2, edit);
    return;
  }
}

void adopt_children(State &state, std::uint32_t bar) {
  Projection &projection = state.projections[bar];
  projection.phase = Phase::growing;
  for (const std::uint32_t child : state.children[bar]) {
    const Phase phase = state.projections[child].phase;
    if (phase != Phase::waiting || state.projections[child].host != none) continue;
    schedule(state, child, bar, projection.start_path);
    projection.waiting.push_back(child);
  }
}

std::vector<std::uint32_t> due_bars(State &state, std::uint32_t host, std::uint32_t first_settled) {
  Projection &carrier = state.projections[host];
  std::vector<std::uint32_t> due;
  if (carrier.waiting.empty() || carrier.settled < 2) return due;
  const double settled_path = carrier.chain[carrier.settled - 1].path;
  for (const std::uint32_t bar : carrier.waiting) {
    Projection &projection = state.projections[bar];
    if (state.parameters.hazard == Hazard::per_step && projection.attempts == 0) {
      const double initiation = state.input.bars.asked_start[bar];
      for (std::uint32_t i = std::max(1u, first_settled); i < carrier.settled; i++) {
        const double path = carrier.chain[i].path;
        if (path > state.input.bars.asked_end[host] - fork_gap_um) break;
        if (conceg_rng_uniform(&projection.chance) >=
            step_probability(state.parameters.lambda_per_um, path, initiation))
          continue;
        projection.fork_path = path;
        due.push_back(bar);
        break;
      }
    } else if (projection.fork_path <= settled_path) {
      due.push_back(bar);
    }
  }
  std::sort(due.begin(), due.end(), [&](std::uint32_t x, std::uint32_t y) {
    const double px = state.projections[x].fork_path, py = state.projections[y].fork_path;
    return px < py || (px == py && x < y);
  });
  for (const std::uint32_t bar : due)
    carrier.waiting.erase(std::find(carrier.waiting.begin(), carrier.waiting.end(), bar));
  return due;
}

bool open_fork(State &state, std::uint32_t bar) {
  Projection &projection = state.projections[bar];
  Projection &host = state.projections[projection.host];
  const Place place = place_on(host, projection.fork_path);
  if (place.path + fork_gap_um > state.input.bars.asked_end[bar]) return false;
  const Vertex &to = host.chain[place.vertex], &from = host.chain[place.vertex - 1];
  const bool at_vertex = place.path == to.path;
  const glm::dvec3 ahead = at_vertex && place.vertex + 1 < host.chain.size()
                               ? host.chain[place.vertex + 1].position - to.position
                               : to.position - from.position;
  projection.fork_heading = glm::normalize(ahead);
  projection.start_path = place.path;
  projection.radius_limit = law_radius(state, projection.host, place.path);
  draw_calibre(state, bar);
  projection.best_path = place.path;
  Vertex start = to;
  start.position = place.position, start.path = place.path, start.segment = none;
  projection.chain.assign(1, start);
  projection.settled = 1;
  projection.fork_nodes[0] = to.node, projection.fork_nodes[1] = from.node;
  for (int a = 0; a < 3; a++)
    projection.fork_lifts[0][a] = to.lift[a], projection.fork_lifts[1][a] = from.lift[a];
  projection.phase = Phase::starting;
  host.forks.push_back({bar, place.vertex, place.position, place.path});
  return true;
}

bool postpone_fork(State &state, std::uint32_t bar) {
  Projection &projection = state.projections[bar];
  Projection &host = state.projections[projection.host];
  host.forks.erase(
      std::remove_if(host.forks.begin(), host.forks.end(), [&](const Fork &fork) { return fork.bar == bar; }),
      host.forks.end());
  projection.chain.clear();
  projection.settled = 0;
  projection.banned.clear();
  projection.collapses = 0;
  projection.fork_path = projection.start_path + postpone_um;
  if (++projection.attempts > state.parameters.retries) return false;
  projection.phase = Phase::waiting;
  return true;
}

std::uint32_t find_host(const State &state, std::uint32_t bar) {
  const Bars &bars = state.input.bars;
  const Projection &projection = state.projections[bar];
  std::uint32_t best = none;
  double best_cost = 0.0;
  for (std::uint64_t row = bars.cell_offset[projection.cell]; row < bars.cell_offset[projection.cell + 1];
       row++) {
    const auto host = static_cast<std::uint32_t>(row);
    const Projection &carrier = state.projections[host];
    if (host == bar || carrier.tree != projection.tree || bars.asked_end[host] < bars.asked_end[bar])
      continue;
    if (carrier.phase != Phase::growing && carrier.phase != Phase::done) continue;
    const double least = carrier.start_path + fork_gap_um;
    if (least + fork_gap_um > bars.asked_end[bar]) continue;
    // The parent bar's own projection first; then where the start can be kept, best ahead of a tip that comes
    // to it.
    const double late = std::max(0.0, least - bars.asked_start[bar]);
    const double ahead = bars.asked_start[bar] - carrier.chain.back().path;
    const double cost = host == projection.parent ? -1.0 : 1e3 * late + (ahead >= 0.0 ? ahead : 1e2 - ahead);
    if (best == none || cost < best_cost) best = host, best_cost = cost;
  }
  return best;
}

void give_to_host(State &state, std::uint32_t bar, std::uint32_t host) {
  Projection &carrier = state.projections[host];
  schedule(state, bar, host, carrier.chain[carrier.settled - 1].path);
  carrier.waiting.push_back(bar);
}

bool may_find_host(const State &state, std::uint32_t bar) {
  const Bars &bars = state.input.bars;
  const Projection &projection = state.projections[bar];
  for (std::uint64_t row = bars.cell_offset[projection.cell]; row < bars.cell_offset[projection.cell + 1];
       row++) {
    const Projection &other = state.projections[row];
    if (row == bar || other.tree != projection.tree || bars.asked_end[row] < bars.asked_end[bar]) continue;
    if (other.phase == Phase::starting) return true;
    if (other.phase == Phase::waiting && other.host != none) return true;
  }
  return false;
}

} // namespace conceg::grow
