// SPDX-License-Identifier: BSD-3-Clause
#include "tension.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace conceg::relax {

namespace {

constexpr double push_share = 0.4;                    // of the largest pull: what is pressed buckles
constexpr double least_scale = 0.7, most_scale = 1.2; // no force grows without bound
constexpr double least_apart = 0.5, most_apart = 1.5; // the same, of forks

} // namespace

Tension::Tension(const Bodies &bodies, const Sections &sections, const Strength &strength, double most_pull)
    : sections_(sections), forking_(strength.forking), tension_(strength.tension),
      straightening_(strength.straightening), most_pull_(most_pull), scale_(sections.count(), 1),
      rest_(bodies.rest_length), chord_(sections.count()), straightness_(sections.count()),
      pull_(sections.count(), 0) {
  for (std::size_t s = 0; s < sections.count(); s++)
    chord_[s] = glm::length(end_to_end(bodies, s)), straightness_[s] = straightness_of(bodies, sections, s);
  for (std::size_t i = 0; i < bodies.points; i++) {
    if (bodies.child_offset[i + 1] - bodies.child_offset[i] != 2) continue;
    const std::uint32_t one = bodies.child[bodies.child_offset[i]],
                        other = bodies.child[bodies.child_offset[i] + 1];
    const glm::dvec3 p = bodies.position[one] - bodies.position[i],
                     q = bodies.position[other] - bodies.position[i];
    const double lengths = glm::length(p) * glm::length(q);
    if (lengths > 0)
      forks_.push_back({static_cast<std::uint32_t>(i), one, other, glm::dot(p, q) / lengths, 1});
  }
}

// The distance of the daughters at which the fork has the angle of the start, um.
double Tension::wanted(const Bodies &bodies, const Fork &fork) {
  const double p = glm::distance(bodies.position[fork.one], bodies.position[fork.at]),
               q = glm::distance(bodies.position[fork.other], bodies.position[fork.at]);
  return std::sqrt(std::max(0.0, p * p + q * q - 2 * p * q * fork.cosine));
}

glm::dvec3 Tension::end_to_end(const Bodies &bodies, std::size_t section) const {
  return bodies.position[sections_.point[sections_.offset[section + 1] - 1]] -
         bodies.position[sections_.point[sections_.offset[section]]];
}

// By how much the ends are nearer to each other than the section's straightness asks, um.
double Tension::missing(const Bodies &bodies, std::size_t section) const {
  const double now = glm::length(end_to_end(bodies, section));
  const double straight = straightness_[section] > 0 ? straightness_of(bodies, sections_, section) : 0;
  return straight > 0 ? now * (straightness_[section] / straight - 1) : chord_[section] - now;
}

void Tension::update(const Bodies &bodies, Workers &workers) {
  workers.loop(sections_.count(), 64, [&](std::size_t s, unsigned) {
    if (!(sections_.length[s] > 0)) return;
    pull_[s] = std::min(most_pull_,
                        std::max(-push_share * most_pull_, pull_[s] + straightening_ * missing(bodies, s)));
    const double change = length_of(bodies, sections_, s) / sections_.length[s] - 1;
    scale_[s] = std::min(most_scale, std::max(least_scale, scale_[s] - tension_ * change));
    for (std::uint32_t n = sections_.offset[s] + 1; n < sections_.offset[s + 1]; n++)
      rest_[sections_.point[n]] = scale_[s] * bodies.rest_length[sections_.point[n]];
  });
  for (Fork &fork : forks_) {
    const double apart = wanted(bodies, fork);
    if (!(apart > 0)) continue;
    const double change = glm::distance(bodies.position[fork.one], bodies.position[fork.other]) / apart - 1;
    fork.scale = std::min(most_apart, std::max(least_apart, fork.scale - tension_ * change));
  }
}

void Tension::add_forces(const Bodies &bodies, std::vector<glm::dvec3> &force) const {
  for (std::size_t s = 0; s < sections_.count(); s++) {
    const glm::dvec3 along = end_to_end(bodies, s);
    const double distance = glm::length(along);
    if (!(distance > 0)) continue;
    const std::uint32_t first = sections_.offset[s], points = sections_.offset[s + 1] - first;
    const double middle = 0.5 * (points - 1);
    const glm::dvec3 unit = pull_[s] / (0.25 * points * distance) * along; // half of the points bear pull_
    for (std::uint32_t n = 0; n < points; n++) {
      const std::uint32_t point = sections_.point[first + n];
      if (!bodies.pinned[point]) force[point] += (n - middle) / middle * unit;
    }
  }
  for (const Fork &fork : forks_) {
    const glm::dvec3 along = bodies.position[fork.one] - bodies.position[fork.other];
    const double now = glm::length(along);
    if (!(now > 0)) continue;
    const glm::dvec3 push = forking_ * (fork.scale * wanted(bodies, fork) - now) / now * along;
    force[fork.one] += push, force[fork.other] -= push; // daughters are never pinned
  }
}

} // namespace conceg::relax
