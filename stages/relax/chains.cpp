// SPDX-License-Identifier: BSD-3-Clause
#include "chains.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::relax {

namespace {

// Path between two elements below which they count as one body, in units of the sum of their radii: siblings
// that leave a fork at 30 degrees are free of each other after 3.9 of them.
constexpr double near_radii = 4.0;

// Coordinates stay where lifts fit into 32 bits and doubles keep a fraction of a nanometre.
constexpr double farthest = 1e7; // um

bool near_enough(const glm::dvec3 &p) {
  return std::abs(p.x) < farthest && std::abs(p.y) < farthest && std::abs(p.z) < farthest;
}

void check_sizes(const Skeletons &s) {
  const std::size_t cells = s.soma.size(), points = s.position.size();
  if (s.cell_offset.size() != cells + 1)
    fail(CONCEG_E_FORMAT, "/skeleton/cell_offset: expected %zu values (cells + 1), got %zu", cells + 1,
         s.cell_offset.size());
  if (s.soma_radius.size() != cells)
    fail(CONCEG_E_FORMAT, "/cells/radius: expected %zu values, got %zu", cells, s.soma_radius.size());
  if (s.radius.size() != points || s.target_radius.size() != points || s.parent.size() != points)
    fail(CONCEG_E_FORMAT,
         "/skeleton: expected %zu values of radius, target_radius and parent, got %zu, %zu and %zu", points,
         s.radius.size(), s.target_radius.size(), s.parent.size());
  if (s.cell_offset.front() != 0 || s.cell_offset.back() != points)
    fail(CONCEG_E_FORMAT, "/skeleton/cell_offset: expected 0 first and %zu last, got %llu and %llu", points,
         static_cast<unsigned long long>(s.cell_offset.front()),
         static_cast<unsigned long long>(s.cell_offset.back()));
  for (std::size_t i = 0; i < cells; i++)
    if (s.cell_offset[i] > s.cell_offset[i + 1])
      fail(CONCEG_E_FORMAT, "/skeleton/cell_offset[%zu]: expected ascending offsets, got %llu before %llu", i,
           static_cast<unsigned long long>(s.cell_offset[i]),
           static_cast<unsigned long long>(s.cell_offset[i + 1]));
  if (points + 2 * cells >= UINT32_MAX / 2)
    fail(CONCEG_E_RANGE, "/skeleton: expected fewer than 2^31 points, got %zu; split the domain", points);
}

void check_values(const Skeletons &s) {
  for (std::size_t i = 0; i < s.soma.size(); i++) {
    if (!near_enough(s.soma[i]))
      fail(CONCEG_E_RANGE, "/cells/soma[%zu]: expected finite coordinates below 1e7 um", i);
    if (!(s.soma_radius[i] >= 0) || !std::isfinite(s.soma_radius[i]))
      fail(CONCEG_E_RANGE, "/cells/radius[%zu]: expected a radius >= 0 um, got %g", i,
           static_cast<double>(s.soma_radius[i]));
  }
  for (std::size_t i = 0; i < s.position.size(); i++) {
    if (!near_enough(s.position[i]))
      fail(CONCEG_E_RANGE, "/skeleton/position[%zu]: expected finite coordinates below 1e7 um", i);
    if (!(s.radius[i] > 0) || !std::isfinite(s.radius[i]))
      fail(CONCEG_E_RANGE, "/skeleton/radius[%zu]: expected a radius > 0 um, got %g", i,
           static_cast<double>(s.radius[i]));
    if (!(s.target_radius[i] > 0) || !std::isfinite(s.target_radius[i]))
      fail(CONCEG_E_RANGE, "/skeleton/target_radius[%zu]: expected a radius > 0 um, got %g", i,
           static_cast<double>(s.target_radius[i]));
  }
}

void add_points(const Skeletons &s, Bodies &b) {
  const std::size_t cells = s.soma.size();
  b.points = s.position.size();
  b.parent.assign(b.points, -1);
  b.path.assign(b.points, 0);
  b.rest_length.assign(b.points, 0);
  b.position = s.position;
  b.elements.reserve(b.points + cells);
  for (std::size_t cell = 0; cell < cells; cell++) {
    const std::size_t first = s.cell_offset[cell], end = s.cell_offset[cell + 1];
    for (std::size_t i = first; i < end; i++) {
      const auto self = static_cast<std::uint32_t>(i);
      const std::int64_t local = s.parent[i];
      if (local < -1 || local >= static_cast<std::int64_t>(i - first))
        fail(CONCEG_E_RANGE, "/skeleton/parent[%zu]: expected -1 or a row of the cell below %zu, got %lld", i,
             i - first, static_cast<long long>(local));
      if (local < 0) {
        b.elements.push_back({self, self, self, self, static_cast<std::uint32_t>(cell)});
        continue;
      }
      const auto parent = static_cast<std::uint32_t>(first + static_cast<std::size_t>(local));
      b.parent[i] = parent;
      b.rest_length[i] = glm::distance(s.position[i], s.position[parent]);
      b.path[i] = b.path[parent] + b.rest_length[i];
      b.elements.push_back({parent, self, parent, self, static_cast<std::uint32_t>(cell)});
    }
  }
}

void add_radii(const Skeletons &s, double radius_min, Bodies &b) {
  for (const float target : s.target_radius) {
    b.radius.push_back(target);
    b.floor.push_back(std::min<double>(target, static_cast<float>(radius_min)));
  }
  for (const float soma : s.soma_radius)
    b.radius.push_back(soma), b.floor.push_back(soma);
  b.reach_radius = b.radius;
}

// A root is joined to its soma by a stub that starts one radius below the soma's surface.
void add_somas_and_stubs(const Skeletons &s, Bodies &b) {
  const std::size_t cells = s.soma.size();
  b.position.insert(b.position.end(), s.soma.begin(), s.soma.end());
  for (std::size_t cell = 0; cell < cells; cell++) {
    const auto node = static_cast<std::uint32_t>(b.points + cell);
    for (std::size_t i = s.cell_offset[cell]; i < s.cell_offset[cell + 1]; i++) {
      if (b.parent[i] >= 0) continue;
      const glm::dvec3 inward = s.soma[cell] - s.position[i];
      const double distance = glm::length(inward);
      if (s.soma_radius[cell] <= 0 || distance <= 0) continue;
      const double depth = std::max(b.radius[i], distance - s.soma_radius[cell] + b.radius[i]);
      b.elements[i].a = static_cast<std::uint32_t>(b.position.size());
      b.position.push_back(s.position[i] + inward * (std::min(depth, distance) / distance));
    }
    if (s.soma_radius[cell] > 0)
      b.elements.push_back({node, node, node, node, static_cast<std::uint32_t>(cell)});
  }
  b.pinned.assign(b.position.size(), 1);
  for (std::size_t i = 0; i < b.points; i++)
    b.pinned[i] = b.parent[i] < 0;
}

void add_children(Bodies &b) {
  b.child_offset.assign(b.points + 1, 0);
  for (std::size_t i = 0; i < b.points; i++)
    if (b.parent[i] >= 0) b.child_offset[static_cast<std::size_t>(b.parent[i]) + 1]++;
  for (std::size_t i = 0; i < b.points; i++)
    b.child_offset[i + 1] += b.child_offset[i];
  b.child.resize(b.child_offset[b.points]);
  std::vector<std::uint32_t> next(b.child_offset.begin(), b.child_offset.end() - 1);
  for (std::size_t i = 0; i < b.points; i++)
    if (b.parent[i] >= 0)
      b.child[next[static_cast<std::size_t>(b.parent[i])]++] = static_cast<std::uint32_t>(i);
}

void add_chunks(Bodies &b) {
  for (std::uint32_t e = 0; e < b.elements.size(); e++) {
    const bool goes_on = e < b.points && e > 0 && b.parent[e] == static_cast<std::int64_t>(e) - 1;
    if (goes_on && b.chunks.back().count < chunk_size)
      b.chunks.back().count++;
    else
      b.chunks.push_back({e, 1});
  }
}

} // namespace

Bodies make_bodies(const Skeletons &skeletons, double radius_min) {
  check_sizes(skeletons);
  check_values(skeletons);
  Bodies bodies;
  add_points(skeletons, bodies);
  add_radii(skeletons, radius_min, bodies);
  add_somas_and_stubs(skeletons, bodies);
  add_children(bodies);
  add_chunks(bodies);
  bodies.rest_bend.resize(bodies.points);
  for (std::size_t i = 0; i < bodies.points; i++)
    bodies.rest_bend[i] = bend_of(bodies, i);
  return bodies;
}

glm::dvec3 bend_of(const Bodies &bodies, std::size_t point) {
  const std::uint32_t first = bodies.child_offset[point], end = bodies.child_offset[point + 1];
  const std::int64_t parent = bodies.parent[point];
  const std::uint32_t neighbours = end - first + (parent >= 0);
  if (neighbours < 2) return glm::dvec3(0);
  glm::dvec3 sum = parent >= 0 ? bodies.position[static_cast<std::size_t>(parent)] : glm::dvec3(0);
  for (std::uint32_t c = first; c < end; c++)
    sum += bodies.position[bodies.child[c]];
  return bodies.position[point] - sum / static_cast<double>(neighbours);
}

bool near_in_tree(const Bodies &bodies, std::uint32_t e, std::uint32_t f) {
  const bool soma_e = e >= bodies.points, soma_f = f >= bodies.points;
  if (soma_e && soma_f) return true;
  const auto start = [&](std::uint32_t i) {
    return bodies.parent[i] < 0 ? bodies.path[i] : bodies.path[i] - bodies.rest_length[i];
  };
  const double limit =
      near_radii * ((soma_e ? 0.0 : bodies.reach_radius[e]) + (soma_f ? 0.0 : bodies.reach_radius[f]));
  if (soma_e) return start(f) < limit;
  if (soma_f) return start(e) < limit;
  // Climb from the later point until both meet; parents come before children.
  std::int64_t x = e, y = f;
  while (x != y) {
    std::int64_t &later = x > y ? x : y;
    if (bodies.parent[static_cast<std::size_t>(later)] < 0) break;
    later = bodies.parent[static_cast<std::size_t>(later)];
    const double gone = std::max(0.0, start(e) - bodies.path[static_cast<std::size_t>(x)]) +
                        std::max(0.0, start(f) - bodies.path[static_cast<std::size_t>(y)]);
    if (gone >= limit) return false;
  }
  if (x == y) {
    if (x == e) return start(f) - bodies.path[e] < limit;
    if (x == f) return start(e) - bodies.path[f] < limit;
    return start(e) + start(f) - 2 * bodies.path[static_cast<std::size_t>(x)] < limit;
  }
  while (bodies.parent[static_cast<std::size_t>(x)] >= 0)
    x = bodies.parent[static_cast<std::size_t>(x)];
  while (bodies.parent[static_cast<std::size_t>(y)] >= 0)
    y = bodies.parent[static_cast<std::size_t>(y)];
  // Two trees of one cell: the way between them runs over the soma.
  const double across = glm::distance(bodies.position[static_cast<std::size_t>(x)],
                                      bodies.position[static_cast<std::size_t>(y)]);
  return start(e) + start(f) + across < limit;
}

} // namespace conceg::relax
