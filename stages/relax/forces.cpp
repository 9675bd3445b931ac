// SPDX-License-Identifier: BSD-3-Clause
#include "forces.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace conceg::relax {

namespace {

// Unit vector from the second body to the first; when the axes meet, across both of them.
glm::dvec3 direction_of(const RoundCone &first, const RoundCone &second, double s, double t) {
  const glm::dvec3 u = first.b - first.a, v = second.b - second.a;
  const glm::dvec3 difference = first.a + s * u - (second.a + t * v);
  const double distance = glm::length(difference);
  if (distance > 1e-9) return difference / distance;
  glm::dvec3 across = glm::cross(u, v);
  if (glm::length(across) <= 1e-9 * (glm::length(u) * glm::length(v)) || glm::length(across) <= 1e-300)
    across = glm::cross(glm::length(u) > 0 ? u : v, glm::dvec3(0.36, 0.48, 0.8));
  const double length = glm::length(across);
  return length > 1e-300 ? across / length : glm::dvec3(1, 0, 0);
}

bool is_pinned(const Bodies &bodies, std::uint32_t element) {
  return bodies.pinned[bodies.elements[element].a] && bodies.pinned[bodies.elements[element].b];
}

// Size of the push: positive apart, negative together.
double push_of(const Strength &k, double gap, bool attract) {
  const double room = gap - k.gap;
  if (room < 0) return -k.repulsion * room;
  if (!attract || room >= k.attraction_range) return 0;
  return -k.attraction * room * (1 - room / k.attraction_range);
}

} // namespace

void PairForces::set_pairs(const Bodies &bodies, std::vector<Pair> pairs) {
  pairs_ = std::move(pairs);
  contacts_.resize(pairs_.size());
  offset_.assign(bodies.elements.size() + 1, 0);
  for (const Pair &p : pairs_)
    offset_[p.e + 1]++, offset_[p.f + 1]++;
  for (std::size_t e = 0; e < bodies.elements.size(); e++)
    offset_[e + 1] += offset_[e];
  incident_.resize(offset_.back());
  std::vector<std::uint64_t> next(offset_.begin(), offset_.end() - 1);
  for (std::size_t k = 0; k < pairs_.size(); k++) {
    incident_[next[pairs_[k].e]++] = 2 * k;
    incident_[next[pairs_[k].f]++] = 2 * k + 1;
  }
}

void PairForces::add(const Bodies &bodies, const Strength &strength, const glm::dvec3 &side, Workers &workers,
                     std::vector<glm::dvec3> &force) {
  workers.loop(pairs_.size(), 1024, [&](std::size_t k, unsigned) {
    RoundCone first, second;
    cones_of(bodies, pairs_[k], bodies.radius, side, first, second);
    const Closest at = closest_axes(first, second);
    const bool one_body =
        same_copy(pairs_[k]) && bodies.elements[pairs_[k].e].cell == bodies.elements[pairs_[k].f].cell;
    const double size = push_of(strength, at.gap, !one_body);
    Contact &contact = contacts_[k];
    contact.s = at.s, contact.t = at.t;
    contact.push = size == 0 ? glm::dvec3(0) : size * direction_of(first, second, at.s, at.t);
    // Small structures yield to large ones: shares in proportion to the other's volume, all of it beside what
    // is pinned.
    const double r = first.radius_a + at.s * (first.radius_b - first.radius_a);
    const double q = second.radius_a + at.t * (second.radius_b - second.radius_a);
    const double volume = r * r * r, other = q * q * q;
    contact.first_share = is_pinned(bodies, pairs_[k].f) ? 1 : other / (volume + other);
    contact.second_share = is_pinned(bodies, pairs_[k].e) ? 1 : volume / (volume + other);
  });
  const auto pull = [&](std::uint32_t element, bool at_end) {
    glm::dvec3 sum(0);
    for (std::uint64_t n = offset_[element]; n < offset_[element + 1]; n++) {
      const Contact &contact = contacts_[incident_[n] / 2];
      const bool is_second = incident_[n] & 1;
      const double along = is_second ? contact.t : contact.s;
      const double share =
          (is_second ? -contact.second_share : contact.first_share) * (at_end ? along : 1 - along);
      sum += share * contact.push;
    }
    return sum;
  };
  workers.loop(bodies.points, 512, [&](std::size_t i, unsigned) {
    if (bodies.pinned[i]) return;
    glm::dvec3 sum = pull(static_cast<std::uint32_t>(i), true);
    for (std::uint32_t c = bodies.child_offset[i]; c < bodies.child_offset[i + 1]; c++)
      sum += pull(bodies.child[c], false);
    force[i] += sum;
  });
}

void add_shape_forces(const Bodies &bodies, const Strength &strength, Workers &workers,
                      std::vector<glm::dvec3> &force) {
  // Force along the segment that ends at point i, on its end.
  const auto tension = [&](std::size_t i) {
    const glm::dvec3 along = bodies.position[i] - bodies.position[static_cast<std::size_t>(bodies.parent[i])];
    const double length = glm::length(along);
    return length > 0 ? along * (strength.stretch * (bodies.rest_length[i] - length) / length)
                      : glm::dvec3(0);
  };
  workers.loop(bodies.points, 512, [&](std::size_t i, unsigned) {
    if (bodies.pinned[i]) return;
    glm::dvec3 sum = tension(i);
    for (std::uint32_t c = bodies.child_offset[i]; c < bodies.child_offset[i + 1]; c++)
      sum -= tension(bodies.child[c]);
    force[i] += sum + strength.bending * (bodies.rest_bend[i] - bend_of(bodies, i));
  });
}

} // namespace conceg::relax
